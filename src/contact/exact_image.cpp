#include "contact/exact_lines.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"

namespace palpate::contact {
namespace {

class ExactImage final : public DepthImage {
 public:
  ExactImage() { counters::count("contact.exact_image"); }

  void answer(std::span<DepthRequest* const> requests) override {
    times_ = {};
    const ScopedTimer timer(times_.passes);
    for (DepthRequest* r : requests) {
      r->layered.clear();
      lines_.through_pixels(*r->a, *r->b, r->camera, r->candidate_gap, r->pairs);
    }
  }

 private:
  ExactLines lines_;
};

}  // namespace

std::unique_ptr<DepthImage> make_exact_image() { return std::make_unique<ExactImage>(); }

}  // namespace palpate::contact
