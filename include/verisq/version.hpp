/// The version of the library, for the preprocessor too. CMake refuses to configure when its own differs.
#pragma once

#define VERISQ_VERSION_MAJOR 0
#define VERISQ_VERSION_MINOR 1
#define VERISQ_VERSION_PATCH 0
#define VERISQ_VERSION "0.1.0"
