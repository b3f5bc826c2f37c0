// Two quadratures of one contact, over the points of either surface, each with half of the weight.
#include <algorithm>

#include "contact/sources.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

class TwoPassSource final : public SampleSource {
 public:
  TwoPassSource(std::unique_ptr<SampleSource> first, std::unique_ptr<SampleSource> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  std::string_view name() const override { return first_->name(); }
  void query(const dynamics::StateView& state, std::vector<ContactSample>& samples) override {
    const std::size_t begin = samples.size();
    first_->query(state, samples);
    count_ = samples.size() - begin;
    second_->query(state, samples);
    const auto a_points = first_->material_points(), b_points = second_->material_points();
    points_.assign(a_points.begin(), a_points.end());
    for (const int point : b_points) points_.push_back(kSecond + point);
    halve({samples.data() + begin, samples.size() - begin});
    const SumError::Query a = first_->sum_error()->last(), b = second_->sum_error()->last();
    sum_error_.take(
        {0.5 * (a.sum + b.sum), 0.5 * (a.error + b.error), 0.5 * std::max(a.largest_term, b.largest_term)});
  }
  std::span<const int> material_points() const override { return points_; }
  bool follows() const override { return first_->follows() && second_->follows(); }
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
  bool has_events() const override { return first_->has_events() || second_->has_events(); }
  long tunnelled() const override { return first_->tunnelled() + second_->tunnelled(); }
  double safe_time() const override { return std::min(first_->safe_time(), second_->safe_time()); }
  long fast_regions() const override { return first_->fast_regions() + second_->fast_regions(); }
  const SumError* sum_error() const override { return &sum_error_; }
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
  PALPATE_CHECK(first->sum_error() && second->sum_error(), "{}: one half has no quadrature error",
                first->name());
  return std::make_unique<TwoPassSource>(std::move(first), std::move(second));
}

}  // namespace palpate::contact
