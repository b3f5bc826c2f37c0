#include "render/available.h"

#include "gl/context.h"

namespace palpate::render {

bool available() { return true; }
void check_available() {}
void release_context() { gl::Context::release_here(); }

}  // namespace palpate::render
