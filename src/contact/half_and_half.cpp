// Two quadratures of one contact, over the points of either surface, each with half of the weight.
#include "contact/half_and_half.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

class TwoPassSource final : public SampleSource {
 public:
  TwoPassSource(std::unique_ptr<SampleSource> first, std::unique_ptr<SampleSource> second)
      : SampleSource(common_traits(*first, *second)), first_(std::move(first)), second_(std::move(second)) {}

  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    const std::size_t begin = samples.size();
    first_->query(state, samples);
    count_ = samples.size() - begin;
    second_->query(state, samples);
    const auto a_points = first_->material_points(), b_points = second_->material_points();
    points_.assign(a_points.begin(), a_points.end());
    for (const int point : b_points) points_.push_back(kSecond + point);
    halve({samples.data() + begin, samples.size() - begin});
    const SumError::Query a = first_->report().sum_error->last(), b = second_->report().sum_error->last();
    sum_error_.take(
        {0.5 * (a.sum + b.sum), 0.5 * (a.error + b.error), 0.5 * std::max(a.largest_term, b.largest_term)});
  }
  std::span<const int> material_points() const override { return points_; }
  void follow(const dynamics::StateView& state, std::span<ContactSample> samples) override {
    first_->follow(state, samples.first(count_));
    second_->follow(state, samples.subspan(count_));
    halve(samples);
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override {
    first_->add_pattern(pattern);
    second_->add_pattern(pattern);
  }
  std::uint64_t pattern_version() const override {
    return first_->pattern_version() + second_->pattern_version();
  }
  SourceReport report() const override {
    const SourceReport a = first_->report(), b = second_->report();
    return {.tunnelled = a.tunnelled + b.tunnelled,
            .safe_time = std::min(a.safe_time, b.safe_time),
            .fast_regions = a.fast_regions + b.fast_regions,
            .sum_error = &sum_error_};
  }
  void archive(Archive& a) override {
    {
      const Archive::Group group(a, "first");
      first_->archive(a);
    }
    {
      const Archive::Group group(a, "second");
      second_->archive(a);
    }
    a("sum_error", sum_error_);
  }

 private:
  static SourceTraits common_traits(const SampleSource& a, const SampleSource& b) {
    return {a.traits().name, a.traits().follows && b.traits().follows,
            a.traits().has_events || b.traits().has_events};
  }
  static void halve(std::span<ContactSample> samples) {
    for (ContactSample& sample : samples) sample.area *= 0.5;
  }

  std::unique_ptr<SampleSource> first_, second_;
  /// Offset of the second source's point indices; larger than the number of points of a side.
  static constexpr int kSecond = 1 << 24;
  std::vector<int> points_;
  std::size_t count_ = 0;  ///< Number of the first source's samples.
  SumError sum_error_;
};

}  // namespace

std::unique_ptr<SampleSource> make_half_and_half(std::unique_ptr<SampleSource> first,
                                                 std::unique_ptr<SampleSource> second) {
  PALPATE_CHECK(first->report().sum_error && second->report().sum_error,
                "{}: one half has no quadrature error", first->traits().name);
  return std::make_unique<TwoPassSource>(std::move(first), std::move(second));
}

}  // namespace palpate::contact
