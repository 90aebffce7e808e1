# Which Python the package is built for and tests run: Debian's, to which its NumPy and selenium belong, unless
# Python3_EXECUTABLE says another; where Debian has none, the first in the path.
find_program(Python3_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(Python3_EXECUTABLE python3)
mark_as_advanced(Python3_EXECUTABLE)
