/* What every C test includes: cmocka with the headers it needs before it. */
#ifndef PL_TESTS_HARNESS_H
#define PL_TESTS_HARNESS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#endif
