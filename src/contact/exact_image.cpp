#include "contact/exact_lines.h"
#include "palpate/core/counters.h"

namespace palpate::contact {
namespace {

class ExactImage final : public DepthImage {
 public:
  ExactImage() { counters::count("contact.exact_image"); }

  void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                  std::vector<FacePair>& pairs, std::vector<std::uint32_t>& layered) override {
    layered.clear();
    lines_.through_pixels(a, b, camera, candidate_gap, pairs);
  }

 private:
  ExactLines lines_;
};

}  // namespace

std::unique_ptr<DepthImage> make_exact_image() { return std::make_unique<ExactImage>(); }

}  // namespace palpate::contact
