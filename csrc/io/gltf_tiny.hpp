/* Includes tinygltf without its code that opens files or decodes images. Internal to io. */
#ifndef PL_IO_GLTF_TINY_HPP
#define PL_IO_GLTF_TINY_HPP

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#endif
