#include "picture.h"

#include "palpate/core/error.h"

namespace palpate::cli {

void take_picture(const loop::World&, const std::string&) { fail("this build has no pictures; configure with -DPALPATE_WITH_GL=ON"); }

}  // namespace palpate::cli
