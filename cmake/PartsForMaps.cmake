# verisq_part_for_maps(NAME BATCH SOURCE... [BATCH SOURCE...] [ALONE SOURCE...]): what `verisq map` needs of the library
# verisq_NAME. The part verisq_NAME_for_maps is compiled once, and linked by the library and by the demo, which builds
# nothing else. Sources of a batch are compiled as one, which saves the compiler their common headers and templates.
#
# Sources of verify/proof stay alone: there a name of one file cannot be taken for that of another. In verify/search a
# test makes sure of it.
function(verisq_part_for_maps name)
  set(part verisq_${name}_for_maps)
  add_library(${part} OBJECT)
  set(batch 0)
  set(group "")
  foreach(word IN LISTS ARGN)
    if(word STREQUAL BATCH)
      math(EXPR batch "${batch} + 1")
      set(group "${part}_${batch}")
    elseif(word STREQUAL ALONE)
      set(group "")
    else()
      target_sources(${part} PRIVATE ${word})
      if(group)
        set_source_files_properties(${word} PROPERTIES UNITY_GROUP ${group})
      endif()
    endif()
  endforeach()
  target_include_directories(${part} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(${part} PRIVATE verisq_options MPFR::MPFR Boost::headers)
  # Each source on its own where headers are not precompiled either.
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    set_target_properties(${part} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # A source that is included is no header: its private types have one definition.
    target_compile_options(${part} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  target_sources(verisq_${name} PRIVATE $<TARGET_OBJECTS:${part}>)
endfunction()
