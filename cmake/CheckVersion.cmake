# One version everywhere: that of project() is what include/verisq/version.hpp, CITATION.cff and
# pyproject.toml say.
set(version_header include/verisq/version.hpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${version_header} CITATION.cff pyproject.toml)

file(READ ${version_header} text)
foreach(part IN ITEMS MAJOR MINOR PATCH)
  if(NOT text MATCHES "#define VERISQ_VERSION_${part} ${PROJECT_VERSION_${part}}\n")
    message(FATAL_ERROR "${version_header}: VERISQ_VERSION_${part} is not ${PROJECT_VERSION_${part}}")
  endif()
endforeach()
if(NOT text MATCHES "#define VERISQ_VERSION \"${PROJECT_VERSION}\"\n")
  message(FATAL_ERROR "${version_header}: VERISQ_VERSION is not \"${PROJECT_VERSION}\"")
endif()

file(READ CITATION.cff text)
if(NOT text MATCHES "\nversion: ${PROJECT_VERSION}\n")
  message(FATAL_ERROR "CITATION.cff: version is not ${PROJECT_VERSION}")
endif()

file(READ pyproject.toml text)
if(NOT text MATCHES "\nversion = \"${PROJECT_VERSION}\"\n")
  message(FATAL_ERROR "pyproject.toml: version is not ${PROJECT_VERSION}")
endif()
