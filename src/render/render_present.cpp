#include "render/available.h"

namespace palpate::render {

bool available() { return true; }
void check_available() {}

}  // namespace palpate::render
