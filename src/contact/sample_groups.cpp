#include "contact/sample_groups.h"

#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

std::size_t hash_of(const ContactSample& s) {
  std::size_t h = static_cast<std::size_t>(s.b.frame + 1);
  for (int i = 0; i < s.a.count; ++i)
    h = h * 1000003u + static_cast<std::size_t>(s.a.node[static_cast<std::size_t>(i)]);
  if (s.b.frame < 0)
    for (int i = 0; i < s.b.count; ++i)
      h = h * 1000003u + static_cast<std::size_t>(s.b.node[static_cast<std::size_t>(i)]);
  return h ^ (h >> 17);
}

Vec4 weights(const SurfacePoint& point) {
  Vec4 out = Vec4::Zero();
  for (int i = 0; i < point.count; ++i) out[i] = point.weight[static_cast<std::size_t>(i)];
  return out;
}

}  // namespace

void SampleGroups::clear() {
  groups_.clear();
  samples_.clear();
  laws_.clear();
  cells_ = nullptr;
}

bool SampleGroups::belongs(const Group& group, const ContactSample& s) const {
  if (group.frame != s.b.frame || group.count_a != s.a.count) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.a.count); ++i)
    if (group.a[i] != s.a.node[i]) return false;
  if (s.b.frame >= 0) return true;
  if (group.count_b != s.b.count) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.b.count); ++i)
    if (group.b[i] != s.b.node[i]) return false;
  return true;
}

/// By open addressing; `table_` holds the groups of this run of samples, which share a normal.
int SampleGroups::group_of(const ContactSample& s, std::size_t first_of_run) {
  const std::size_t mask = table_.size() - 1;
  for (std::size_t at = hash_of(s) & mask;; at = (at + 1) & mask) {
    int& entry = table_[at];
    if (entry >= static_cast<int>(first_of_run)) {
      if (belongs(groups_[static_cast<std::size_t>(entry)], s)) return entry;
      continue;
    }
    entry = static_cast<int>(groups_.size());
    Group group;
    group.pair = s.source;
    group.frame = s.b.frame;
    group.count_a = s.a.count;
    group.a = s.a.node;
    if (s.b.frame < 0) group.count_b = s.b.count, group.b = s.b.node;
    group.normal = s.normal;
    group.law = static_cast<int>(laws_.size()) - 1;
    groups_.push_back(group);
    return entry;
  }
}

void SampleGroups::append(std::span<const ContactSample> samples, const PressureLaw& law) {
  laws_.push_back(law);
  std::size_t size = 16;
  while (size < 2 * samples.size()) size *= 2;
  table_.assign(size, -1);
  group_of_sample_.resize(samples.size());
  const std::size_t first_group = groups_.size();
  std::size_t first_of_run = first_group;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    PALPATE_CHECK(samples[i].a.frame < 0, "a contact sample has a frame on its first side");
    if (i > 0 && samples[i].normal != samples[i - 1].normal) first_of_run = groups_.size();
    // neighbours in a row of pixels mostly share their nodes: no search
    const int last = i > 0 ? group_of_sample_[i - 1] : -1;
    group_of_sample_[i] =
        last >= static_cast<int>(first_of_run) && belongs(groups_[static_cast<std::size_t>(last)], samples[i])
            ? last
            : group_of(samples[i], first_of_run);
  }
  fill(samples, first_group);
}

/// Sorts the samples by group, in their own order within each.
void SampleGroups::fill(std::span<const ContactSample> samples, std::size_t first_group) {
  const std::size_t before = samples_.size();
  samples_.resize(before + samples.size());
  for (const int g : group_of_sample_) ++groups_[static_cast<std::size_t>(g)].last;
  int next = static_cast<int>(before);
  for (std::size_t g = first_group; g < groups_.size(); ++g) {
    const int count = groups_[g].last;
    groups_[g].first = groups_[g].last = next;
    next += count;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ContactSample& s = samples[i];
    Group& group = groups_[static_cast<std::size_t>(group_of_sample_[i])];
    Sample& at = samples_[static_cast<std::size_t>(group.last++)];
    at.y << weights(s.a), s.b.frame < 0 ? Vec4(-weights(s.b)) : -s.b.offset.homogeneous();
    at.area = s.area;
    at.shift = s.normal.dot(s.a.offset - (s.b.frame < 0 ? s.b.offset : s.b.slide));
  }
}

void SampleGroups::append(const SampleCells& cells, std::size_t first, std::size_t last,
                          const PressureLaw& law) {
  laws_.push_back(law);
  cells_ = &cells;
  for (std::size_t c = first; c < last; ++c) {
    const ContactCell& cell = cells.cells[c];
    const Carrier &a = cells.carriers[static_cast<std::size_t>(cell.a)],
                  &b = cells.carriers[static_cast<std::size_t>(cell.b)];
    Group group;
    group.first = cell.first;
    group.last = cell.last;
    group.cell = static_cast<int>(c);
    group.pair = cell.pair;
    group.frame = b.frame;
    group.count_a = a.count;
    group.a = a.node;
    group.count_b = b.count;
    group.b = b.node;
    group.normal = cell.normal;
    group.law = static_cast<int>(laws_.size()) - 1;
    groups_.push_back(group);
  }
}

}  // namespace palpate::contact
