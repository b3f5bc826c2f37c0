#pragma once

namespace palpate::render {

/// Whether this build draws pictures (PALPATE_WITH_GL).
bool available();
/// @throws Error where it does not, with what to configure
void check_available();

}  // namespace palpate::render
