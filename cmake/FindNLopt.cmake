# Finds NLopt's C library and defines the target NLopt::NLopt. Installed with the package, for its users too. The
# package's own configuration is not used: Debian has two (of the C and of the C++ library) that answer to one name.
find_path(NLOPT_INCLUDE_DIR nlopt.h)
find_library(NLOPT_LIBRARY nlopt)
mark_as_advanced(NLOPT_INCLUDE_DIR NLOPT_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NLopt REQUIRED_VARS NLOPT_LIBRARY NLOPT_INCLUDE_DIR)

if(NLopt_FOUND AND NOT TARGET NLopt::NLopt)
  add_library(NLopt::NLopt UNKNOWN IMPORTED)
  set_target_properties(NLopt::NLopt PROPERTIES IMPORTED_LOCATION "${NLOPT_LIBRARY}"
                                                INTERFACE_INCLUDE_DIRECTORIES "${NLOPT_INCLUDE_DIR}")
endif()
