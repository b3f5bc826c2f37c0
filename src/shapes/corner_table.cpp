#include "corner_table.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::shapes {
namespace {

std::uint64_t edge(int a, int b) {
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
}

}  // namespace

CornerTable::CornerTable(const Faces& faces, int vertices) {
  origin.assign(faces.data(), faces.data() + faces.size());
  twin.assign(origin.size(), -1);
  out.assign(static_cast<std::size_t>(vertices), -1);
  std::vector<std::pair<std::uint64_t, int>> halves;  // sorted by edge, in either direction
  halves.reserve(origin.size());
  for (int h = 0; h < static_cast<int>(origin.size()); ++h) {
    out[origin[h]] = h;
    halves.emplace_back(edge(std::min(from(h), to(h)), std::max(from(h), to(h))), h);
  }
  std::sort(halves.begin(), halves.end());
  for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
    if (halves[i].first != halves[i + 1].first) continue;
    const int h = halves[i].second, t = halves[i + 1].second;
    PALPATE_CHECK(twin[h] < 0 && from(h) == to(t),
                  "edge {} {} is in more than two faces, or has the same direction in two", from(h), to(h));
    join(h, t);
  }
  std::unordered_map<int, int> rim;  // from a vertex along the rim, against the orientation of the faces
  std::vector<int> rim_starts;
  for (int h = 0; h < static_cast<int>(origin.size()); ++h) {
    if (twin[h] >= 0) continue;
    PALPATE_CHECK(rim.emplace(to(h), h).second, "two rims meet at vertex {}", to(h));
    rim_starts.push_back(h);
  }
  first_ghost = last_ghost = vertices;
  for (const int start : rim_starts) {
    if (twin[start] >= 0) continue;
    const int ghost = add_vertex();
    last_ghost = ghost + 1;
    const int first_face = static_cast<int>(origin.size()) / 3;
    int h = start, count = 0;
    do {  // the ghost's faces follow the order of the rim
      const int f = first_face + count++;
      origin.resize(origin.size() + 3);
      twin.resize(twin.size() + 3, -1);
      const int a = to(h), b = from(h);
      face(f, a, b, ghost);
      join(3 * f, h);
      h = rim.at(b);
    } while (h != start);
    for (int i = 0; i < count; ++i) join(3 * (first_face + i) + 1, 3 * (first_face + (i + 1) % count) + 2);
  }
}

void CornerTable::face(int f, int a, int b, int c) {
  origin[3 * f] = a, origin[3 * f + 1] = b, origin[3 * f + 2] = c;
  out[a] = 3 * f, out[b] = 3 * f + 1, out[c] = 3 * f + 2;
}

void CornerTable::join(int h, int t) { twin[h] = t, twin[t] = h; }

int CornerTable::add_vertex() {
  out.push_back(-1);
  return static_cast<int>(out.size()) - 1;
}

int CornerTable::valence(int v) const {
  int n = 0;
  around(v, [&](int) { ++n; });
  return n;
}

// Faces (a, b, c) and (b, a, d) on the edge h = ab become (c, a, d) and (d, b, c).
void CornerTable::flip(int h) {
  const int t = twin[h], a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const int bc = twin[next(h)], ca = twin[previous(h)], ad = twin[next(t)], db = twin[previous(t)], f = h / 3,
            g = t / 3;
  face(f, c, a, d);
  face(g, d, b, c);
  join(3 * f, ca), join(3 * f + 1, ad), join(3 * f + 2, 3 * g + 2), join(3 * g, db), join(3 * g + 1, bc);
}

// Faces (a, b, c) and (b, a, d) become (a, m, c), (m, b, c), (m, a, d), (b, m, d).
void CornerTable::split(int h, int m) {
  const int t = twin[h], a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const int bc = twin[next(h)], ca = twin[previous(h)], ad = twin[next(t)], db = twin[previous(t)], f = h / 3,
            g = t / 3;
  const int e = static_cast<int>(origin.size()) / 3, k = e + 1;
  origin.resize(origin.size() + 6);
  twin.resize(twin.size() + 6, -1);
  face(f, a, m, c);
  face(e, m, b, c);
  face(g, m, a, d);
  face(k, b, m, d);
  join(3 * f, 3 * g), join(3 * f + 1, 3 * e + 2), join(3 * f + 2, ca);
  join(3 * e, 3 * k), join(3 * e + 1, bc);
  join(3 * g + 1, ad), join(3 * g + 2, 3 * k + 1);
  join(3 * k + 2, db);
}

void CornerTable::collapse(int h) {
  const int t = twin[h], a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const int bc = twin[next(h)], ca = twin[previous(h)], ad = twin[next(t)], db = twin[previous(t)];
  std::vector<int> leaving;
  around(a, [&](int o) { leaving.push_back(o); });
  for (const int o : leaving) origin[o] = b;
  for (const int f : {h / 3, t / 3})
    for (int k = 0; k < 3; ++k) origin[3 * f + k] = -1;
  join(bc, ca);
  join(ad, db);
  out[a] = -1, out[b] = ca, out[c] = bc, out[d] = ad;
}

bool CornerTable::can_flip(int h) const {
  const int c = opposite(h), d = opposite(twin[h]);
  if (c == d) return false;
  bool joined = false;
  const int from_c = is_ghost(c) ? d : c, other = is_ghost(c) ? c : d;
  around(from_c, [&](int o) { joined = joined || to(o) == other; });
  return !joined;
}

bool CornerTable::can_collapse(int h) const {
  const int a = from(h), b = to(h), c = opposite(h), d = opposite(twin[h]);
  if (c == d) return false;
  int shared = 0;
  around(a, [&](int o) {
    const int v = to(o);
    around(b, [&](int q) { shared += to(q) == v ? 1 : 0; });
  });
  if (shared != 2) return false;
  for (const int v : {c, d})
    if (!is_ghost(v) && valence(v) < 4) return false;
  return true;
}

}  // namespace palpate::shapes
