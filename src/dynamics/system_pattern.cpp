#include <algorithm>

#include "core/huge_pages.h"
#include "dynamics/border.h"
#include "palpate/dynamics/system.h"

namespace palpate::dynamics {
namespace {

/// FNV-1a hash over version numbers: changes when any of them does.
struct VersionHash {
  std::uint64_t value = 1469598103934665603ull;
  void add(std::uint64_t v) { value = (value ^ v) * 1099511628211ull; }
};

}  // namespace

// Pairs of a term are kept until its version changes: where contact changes its coupling, the element pairs,
// which are the majority, are merged and not sorted again.
void System::update_pattern(const StateView& state) {
  const Layout& layout = *state.layout;
  VersionHash key;
  key.add(layout.version);
  for (const auto& term : terms_) key.add(term->pattern_version());
  if (key.value == pattern_key_ && pattern_.block_rows() == layout.node_count()) return;
  if (pairs_layout_ != layout.version || term_pairs_.size() != terms_.size() ||
      pattern_.block_rows() != layout.node_count()) {
    term_pairs_.assign(terms_.size(), {});
    PatternBuilder builder(layout);
    for (const auto& inertia : inertias_) inertia->add_pattern(builder);
    mass_pairs_ = builder.pairs();
    pairs_layout_ = layout.version;
  }
  std::vector<const NodePairs*> lists{&mass_pairs_};
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    TermPairs& kept = term_pairs_[i];
    if (const std::uint64_t version = terms_[i]->pattern_version(); !kept.known || kept.version != version) {
      PatternBuilder builder(layout);
      terms_[i]->add_pattern(builder);
      kept = {true, version, builder.pairs()};
    }
    lists.push_back(&kept.pairs);
  }
  pattern_ = pattern_of(layout.node_count(), lists);
  pattern_key_ = key.value;
}

void System::ensure_pattern(const StateView& state, BorderedMatrix& A) {
  update_pattern(state);
  const Layout& layout = *state.layout;
  if (A.body.pattern_version() != pattern_.pattern_version()) {
    A.body = pattern_;
    prefer_huge_pages(A.body.values());
  }
  resize_border(A, layout.nodal_size, layout.border_size());
}

const BlockSparse& System::updated_pattern(const StateView& state) {
  update_pattern(state);
  return pattern_;
}

}  // namespace palpate::dynamics
