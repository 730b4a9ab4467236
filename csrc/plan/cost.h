/* The model of costs: what a frame takes is the sum over what it does, base/work.h, of counts times
 * costs. */
#ifndef PL_PLAN_COST_H
#define PL_PLAN_COST_H

#include "base/work.h"

/* What a unit of work costs on the machine of the table that ships, nanoseconds of one thread.
 * Frames depend on this table alone, so that they are the same on every machine. */
double pl_cost_ns(pl_work what);

#endif
