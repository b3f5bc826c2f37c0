#include <fmt/format.h>

#include <filesystem>

#include "palpate/store/csv.h"
#include "palpate/study/compare.h"

namespace palpate::study {
