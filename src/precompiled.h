// What nearly every source includes, parsed once (CMake's precompiled headers).  Every source still includes
// what it uses: PALPATE_PRECOMPILE=OFF builds without this file.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
