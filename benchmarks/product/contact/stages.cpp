#include "product/contact.h"

namespace palpate::bench {

std::string_view name_of(ContactStage stage) {
  constexpr std::array<std::string_view, kContactStages> kNames{"skins",  "regions", "faces",    "upload",
                                                                "passes", "gather",  "readback", "gaps",
                                                                "rest",   "forces",  "tangent"};
  return kNames[static_cast<std::size_t>(stage)];
}

}  // namespace palpate::bench
