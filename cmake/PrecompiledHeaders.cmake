# The headers of the standard library that most files include, parsed once for each part of the project. Sources name
# all that they use all the same: CMAKE_DISABLE_PRECOMPILE_HEADERS (the preset fuzz sets it) compiles them without.
set(standard_headers <algorithm> <array> <chrono> <cmath> <cstddef> <cstdint> <filesystem> <functional> <limits> <map>
                     <memory> <numeric> <optional> <span> <stdexcept> <string> <string_view> <utility> <vector>)
