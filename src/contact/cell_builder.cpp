#include "contact/cell_builder.h"

#include <algorithm>

#include "palpate/core/counters.h"
#include "palpate/mesh/embedding.h"

namespace palpate::contact {

void CellBuilder::start(Side& side, const ImageSide& surface) {
  side.surface = &surface;
  if (side.index.empty()) side.index.assign(static_cast<std::size_t>(surface.carrier_count()), -1);
  for (const int number : side.numbers) side.index[static_cast<std::size_t>(number)] = -1;
  side.numbers.clear();
}

void CellBuilder::start(const ContactAxes& axes, const ImageSide& a, const ImageSide& b, double area,
                        SampleCells& out) {
  axes_ = axes;
  area_ = area;
  out_ = &out;
  first_cell_ = out.cells.size();
  start(a_, a);
  start(b_, b);
  pending_.clear();
  table_.assign(64, -1);
}

int CellBuilder::carrier(Side& side, int number) {
  int& index = side.index[static_cast<std::size_t>(number)];
  if (index >= 0) return index;
  index = static_cast<int>(out_->carriers.size());
  side.numbers.push_back(number);
  out_->carriers.push_back(side.surface->carrier(number, axes_));
  out_->carriers.back().number = number;
  return index;
}

int CellBuilder::carrier(Side& side, int face, const Vec3& weights, const Vec3& place) {
  Eigen::Index nearest = 0;
  weights.maxCoeff(&nearest);
  const ImageSide& surface = *side.surface;
  const auto choice = [&](int c) {
    return carrier(side, surface.carrier_choice(face, static_cast<int>(nearest), c));
  };
  constexpr double kRounding = 1e-9;  // a vertex's own weights may be the largest
  const auto is_bounded = [&](int index) {
    const Carrier& carrier = out_->carriers[static_cast<std::size_t>(index)];
    return carrier.frame >= 0 || (carrier.by_place * (place - carrier.at).homogeneous()).cwiseAbs().sum() <=
                                     (1.0 + kRounding) * mesh::kLargestWeightSum;
  };
  int index = choice(0);
  if (is_bounded(index)) return index;
  counters::count("contact.squashed_tetrahedron");
  const int choices = surface.carrier_choices();
  for (int c = 1; c < choices; ++c)
    if (index = choice(c); is_bounded(index)) break;
  return index;
}

/// By open addressing; carriers are of this region, so a cell is, too.
int CellBuilder::cell_of(int a, int b) {
  std::vector<ContactCell>& cells = out_->cells;
  if (2 * (cells.size() - first_cell_) >= table_.size()) {
    table_.assign(2 * table_.size(), -1);
    for (std::size_t c = first_cell_; c < cells.size(); ++c)
      *slot(cells[c].a, cells[c].b) = static_cast<int>(c);
  }
  int* at = slot(a, b);
  if (*at < 0) {
    *at = static_cast<int>(cells.size());
    ContactCell cell;
    cell.a = a;
    cell.b = b;
    cell.area = area_;
    cell.normal = axes_.normal();
    cells.push_back(cell);
  }
  return *at;
}

int* CellBuilder::slot(int a, int b) {
  const std::size_t mask = table_.size() - 1;
  const auto hash = static_cast<std::size_t>(a) * 1000003u + static_cast<std::size_t>(b);
  for (std::size_t at = (hash ^ (hash >> 17)) & mask;; at = (at + 1) & mask) {
    if (table_[at] < 0) return &table_[at];
    const ContactCell& cell = out_->cells[static_cast<std::size_t>(table_[at])];
    if (cell.a == a && cell.b == b) return &table_[at];
  }
}

void CellBuilder::add(const Facing& at, int face_a, int face_b, double own_area) {
  const int a = carrier(a_, face_a, at.weights_a, {at.u, at.v, at.w_a}),
            b = carrier(b_, face_b, at.weights_b, {at.u, at.v, at.w_b});
  // neighbours in a row of pixels mostly share their carriers: no search
  int cell = pending_.empty() ? -1 : pending_.back().cell;
  if (cell < 0 || out_->cells[static_cast<std::size_t>(cell)].a != a ||
      out_->cells[static_cast<std::size_t>(cell)].b != b)
    cell = cell_of(a, b);
  ++out_->cells[static_cast<std::size_t>(cell)].last;
  pending_.push_back({{at.u, at.v, at.w_a, at.w_b}, cell, own_area});
}

/// Sorts the samples by cell, in their own order within each.
void CellBuilder::finish() {
  int next = out_->count();
  for (std::size_t c = first_cell_; c < out_->cells.size(); ++c) {
    ContactCell& cell = out_->cells[c];
    const int count = cell.last;
    cell.first = cell.last = next;
    next += count;
  }
  out_->places.resize(static_cast<std::size_t>(next));
  const bool own = area_ < 0.0;
  if (own) out_->areas.resize(out_->places.size());
  for (const Pending& p : pending_) {
    ContactCell& cell = out_->cells[static_cast<std::size_t>(p.cell)];
    const auto at = static_cast<std::size_t>(cell.last++);
    const Vec3& from = out_->carriers[static_cast<std::size_t>(cell.a)].at;
    out_->places[at] = {p.place.u - from.x(), p.place.v - from.y(), p.place.w_a - from.z(),
                        p.place.w_b - from.z()};
    if (own) out_->areas[at] = p.area;
  }
}

}  // namespace palpate::contact
