#pragma once

namespace palpate::render {

/// Whether this build can draw pictures (PALPATE_WITH_GL).
bool available();
/// Checks that this build can draw pictures.  @throws Error with the configure option, where it cannot
void check_available();
/// Releases the GL context of this thread, if it has one, so that another thread can draw.
void release_context();

}  // namespace palpate::render
