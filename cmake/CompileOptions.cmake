# Language level, warnings and sanitizers, as one interface target that every target of the project
# links privately: none of them reaches the users of the installed package.
add_library(verisq_options INTERFACE)
target_compile_features(verisq_options INTERFACE cxx_std_20)
# Proofs need every operation as written: no contraction into fma, no value-changing optimisation.
target_compile_options(verisq_options INTERFACE -ffp-contract=off -fno-fast-math -Wall -Wextra -Wpedantic -Wshadow
                                                -Wconversion -Wno-sign-conversion)
# In shared objects, too, nobody replaces our functions by others: calls among them are direct, and may be inlined.
target_compile_options(verisq_options INTERFACE
                       $<$<BOOL:$<TARGET_PROPERTY:POSITION_INDEPENDENT_CODE>>:-fno-semantic-interposition>)
# Templates make GCC collect garbage again and again; with half a gibibyte of room it compiles a tenth faster.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(verisq_options INTERFACE --param=ggc-min-expand=1000 --param=ggc-min-heapsize=524288)
endif()
if(VERISQ_WARNINGS_AS_ERRORS)
  target_compile_options(verisq_options INTERFACE -Werror)
endif()
if(VERISQ_SANITIZE)
  target_compile_options(verisq_options INTERFACE -fsanitize=${VERISQ_SANITIZE} -fno-omit-frame-pointer
                                                  -fno-sanitize-recover=all)
  target_link_options(verisq_options INTERFACE -fsanitize=${VERISQ_SANITIZE})
endif()
