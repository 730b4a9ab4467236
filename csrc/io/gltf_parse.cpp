/* Compiles the implementation of tinygltf. */
#include <fstream> /* for its writer, which does not include it under TINYGLTF_NO_FS */

#define TINYGLTF_IMPLEMENTATION
#include "io/gltf_tiny.hpp"
