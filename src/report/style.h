#pragma once

namespace palpate::report {

/// Style sheet of the page.
extern const char* const kStyleSheet;

}  // namespace palpate::report
