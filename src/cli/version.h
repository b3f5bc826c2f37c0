#pragma once
#include <string>

namespace palpate::cli {

std::string version_text();  ///< "palpate 0.1.0 (commit 1a2b3c4)", or without the commit where the source came without git

}  // namespace palpate::cli
