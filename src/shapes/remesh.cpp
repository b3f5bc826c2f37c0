#include "remesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::shapes {
namespace {

// Botsch and Kobbelt 2004: with these limits splits and collapses do not undo each other.
constexpr double kLongest = 4.0 / 3.0, kShortest = 4.0 / 5.0;

double cotangent(const Vec3& at, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - at, v = b - at;
  return u.dot(v) / std::max(u.cross(v).norm(), 1e-300);
}

}  // namespace

Remesher::Remesher(const TriMesh& mesh, RemeshRules rules)
    : table_(mesh.faces, static_cast<int>(mesh.vertices.cols())), rules_(std::move(rules)) {
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    x_.push_back(mesh.vertices.col(v));
    size_.push_back(size_at(x_.back()));
  }
  x_.resize(table_.out.size(), Vec3::Zero());
  size_.resize(table_.out.size(), 1.0);
  rim_.resize(table_.out.size(), 0);
  for (int ghost = table_.first_ghost; ghost < table_.last_ghost; ++ghost)
    table_.around(ghost, [&](int h) { rim_[table_.to(h)] = 1; });
}

/// Computes gradient and value from four values at the corners of a small tetrahedron.  The error of their
/// mean is O(probe^2); the error of the gradient is O(probe), from mixed second derivatives only.
Vec3 Remesher::slope(const Vec3& p, double* value) const {
  static const std::array<Vec3, 4> corners = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1),
                                              Vec3(-1, -1, 1)};
  Vec3 gradient = Vec3::Zero();
  double sum = 0.0;
  for (const Vec3& c : corners) {
    const double f = rules_.inside(p + rules_.probe * c);
    gradient += f * c;
    sum += f;
  }
  *value = 0.25 * sum;
  return gradient / (4.0 * rules_.probe);
}

/// Performs two Newton steps along the gradient, each no longer than `reach`.
Vec3 Remesher::on_surface(Vec3 p, bool in_plane, double reach) const {
  for (int step = 0; step < 2; ++step) {
    double f;
    Vec3 g = slope(p, &f);
    if (in_plane) g.x() = 0.0;
    const double g2 = g.squaredNorm();
    if (g2 < 1e-6) return p;
    Vec3 move = -f / g2 * g;
    const double length = move.norm();
    if (length > reach) move *= reach / length;
    p += move;
    if (length < 0.01 * reach) break;
  }
  return p;
}

double Remesher::relative(int h) const {
  const int a = table_.from(h), b = table_.to(h);
  return (x_[a] - x_[b]).norm() / (0.5 * (size_[a] + size_[b]));
}

Vec3 Remesher::area_vector(int h) const {
  const Vec3 &a = x_[table_.from(h)], &b = x_[table_.to(h)], &c = x_[table_.opposite(h)];
  return 0.5 * (b - a).cross(c - a);
}

Vec3 Remesher::ring_vector(int v) const {
  Vec3 sum = Vec3::Zero();
  table_.around(v, [&](int h) {
    if (!table_.is_ghost(table_.to(h)) && !table_.is_ghost(table_.opposite(h))) sum += area_vector(h);
  });
  return sum;
}

int Remesher::count() const {
  int n = 0;
  for (int v = 0; v < static_cast<int>(x_.size()); ++v)
    if (table_.out[v] >= 0 && !table_.is_ghost(v)) n += rules_.rims_in_plane && !is_rim(v) ? 2 : 1;
  return n;
}

// A uniform mesh has two triangles per vertex, each of area sqrt(3)/4 (size edge)^2: the number of vertices
// is the integral of dA 2 / (sqrt(3) size^2 edge^2).
double Remesher::edge_for(int vertices) const {
  double sum = 0.0;
  for (int h = 0; h < static_cast<int>(table_.origin.size()); h += 3) {
    if (table_.gone(h) || table_.is_ghost(table_.from(h)) || table_.is_ghost(table_.to(h)) ||
        table_.is_ghost(table_.opposite(h)))
      continue;
    const double size = (size_[table_.from(h)] + size_[table_.to(h)] + size_[table_.opposite(h)]) / 3.0;
    sum += area_vector(h).norm() / (size * size);
  }
  if (rules_.rims_in_plane) sum *= 2.0;
  return std::sqrt(2.0 / std::sqrt(3.0) * sum / vertices);
}

bool Remesher::try_split(int h) {
  const bool on_rim = table_.on_rim(h);
  if (on_rim && !rules_.rims_in_plane) return false;
  const int a = table_.from(h), b = table_.to(h);
  const double length = (x_[a] - x_[b]).norm();
  Vec3 middle = 0.5 * (x_[a] + x_[b]);
  if (on_rim) middle.x() = 0.0;
  // moved off the plane
  else if (is_chord(h))
    middle = 0.5 * middle + 0.25 * (x_[table_.opposite(h)] + x_[table_.opposite(table_.twin[h])]);
  const int m = table_.add_vertex();
  x_.push_back(on_surface(middle, on_rim, 0.25 * length));
  size_.push_back(size_at(x_.back()));
  rim_.push_back(on_rim ? 1 : 0);
  table_.split(h, m);
  return true;
}

/// Collapses from(h) into to(h) unless an edge grows beyond `longest` [target lengths], a face turns over or
/// becomes a sliver, or a rim changes.
bool Remesher::try_collapse(int h, double longest) {
  const int a = table_.from(h), b = table_.to(h), c = table_.opposite(h), d = table_.opposite(table_.twin[h]);
  if (is_rim(a) && (!rules_.rims_in_plane || !table_.on_rim(h))) return false;
  if (!table_.can_collapse(h)) return false;
  const Vec3 ring = ring_vector(a).normalized();
  bool fine = true;
  table_.around(a, [&](int o) {
    const int v = table_.to(o), w = table_.opposite(o);
    if (!fine || table_.is_ghost(v)) return;
    // a new chord
    if (rules_.rims_in_plane && is_rim(b) && is_rim(v) && v != c && v != d && !table_.on_rim(o)) fine = false;
    if (v != b && (x_[v] - x_[b]).norm() > longest * 0.5 * (size_[v] + size_[b])) fine = false;
    if (table_.is_ghost(w) || v == b || w == b) return;
    const Vec3 after = (x_[v] - x_[b]).cross(x_[w] - x_[b]), before = (x_[v] - x_[a]).cross(x_[w] - x_[a]);
    const double longest2 = std::max(
        {(x_[v] - x_[b]).squaredNorm(), (x_[w] - x_[b]).squaredNorm(), (x_[v] - x_[w]).squaredNorm()});
    const double size = after.norm();
    const double quality = size / longest2,
                 quality_before =
                     before.norm() / std::max({(x_[v] - x_[a]).squaredNorm(), (x_[w] - x_[a]).squaredNorm(),
                                               (x_[v] - x_[w]).squaredNorm()});
    if (quality < std::min(0.15, 0.8 * quality_before)) fine = false;  // a new sliver
    if (after.dot(ring) < 0.3 * size ||
        (quality_before > 0.2 && after.dot(before) < 0.5 * size * before.norm()))
      fine = false;
  });
  if (!fine) return false;
  table_.collapse(h);
  return true;
}

void Remesher::split_long(double edge) {
  for (int sweep = 0; sweep < 2; ++sweep) {
    const int edges = static_cast<int>(table_.origin.size());  // new edges wait for the next sweep
    for (int h = 0; h < edges; ++h)
      if (real(h) && h < table_.twin[h] && (relative(h) > kLongest * edge || is_chord(h))) try_split(h);
  }
}

void Remesher::collapse_short(double edge) {
  for (int h = 0; h < static_cast<int>(table_.origin.size()); ++h)
    if (real(h) && relative(h) < kShortest * edge) try_collapse(h, kLongest * edge);
}

// Flips an edge if that reduces the sum of |valence - 6| over the four vertices (4 on a rim, real neighbours
// only).
void Remesher::flip_by_valence() {
  std::vector<int> valence(x_.size(), 0);
  for (int v = 0; v < static_cast<int>(x_.size()); ++v)
    if (table_.out[v] >= 0 && !table_.is_ghost(v)) valence[v] = table_.valence(v) - (is_rim(v) ? 1 : 0);
  for (int h = 0; h < static_cast<int>(table_.origin.size()); ++h) {
    if (!real(h) || h > table_.twin[h] || table_.on_rim(h)) continue;
    const int t = table_.twin[h], a = table_.from(h), b = table_.to(h), c = table_.opposite(h),
              d = table_.opposite(t);
    const auto away = [&](int v, int change) { return std::abs(valence[v] + change - (is_rim(v) ? 4 : 6)); };
    if (away(a, -1) + away(b, -1) + away(c, 1) + away(d, 1) >=
        away(a, 0) + away(b, 0) + away(c, 0) + away(d, 0))
      continue;
    if (is_rim(c) && is_rim(d) && rules_.rims_in_plane) continue;
    const Vec3 before = area_vector(h) + area_vector(t);
    const Vec3 one = 0.5 * (x_[a] - x_[c]).cross(x_[d] - x_[c]),
               two = 0.5 * (x_[b] - x_[d]).cross(x_[c] - x_[d]);
    if (one.dot(before) < 0.8 * one.norm() * before.norm() ||
        two.dot(before) < 0.8 * two.norm() * before.norm())
      continue;
    const double longest2 = (x_[c] - x_[d]).squaredNorm();
    if (std::min(one.norm(), two.norm()) < 0.15 * longest2 || !table_.can_flip(h)) continue;
    table_.flip(h);
    --valence[a], --valence[b], ++valence[c], ++valence[d];
  }
}

// Delaunay criterion: the angles opposite an edge add up to less than pi, so cot + cot > 0; otherwise the
// flip raises the smallest angle.
int Remesher::flip_by_angle() {
  int flips = 0;
  for (int h = 0; h < static_cast<int>(table_.origin.size()); ++h) {
    if (!real(h) || h > table_.twin[h] || table_.on_rim(h)) continue;
    const int t = table_.twin[h];
    const Vec3 &a = x_[table_.from(h)], &b = x_[table_.to(h)], &c = x_[table_.opposite(h)],
               &d = x_[table_.opposite(t)];
    if (cotangent(c, a, b) + cotangent(d, a, b) > -1e-3) continue;
    const Vec3 before = area_vector(h) + area_vector(t), one = (a - c).cross(d - c),
               two = (b - d).cross(c - d);
    if (one.dot(before) < 0.7 * one.norm() * before.norm() ||
        two.dot(before) < 0.7 * two.norm() * before.norm())
      continue;
    if (rules_.rims_in_plane && is_rim(table_.opposite(h)) && is_rim(table_.opposite(t))) continue;
    if (!table_.can_flip(h)) continue;
    table_.flip(h);
    ++flips;
  }
  return flips;
}

// Moves vertices towards the mean of the centroids of the adjacent faces, weighted by area / size^2 (equal
// for triangles of the target size), within the tangent plane.  A rim vertex in the plane moves towards the
// middle of its two neighbours along the rim.  A move that turns a face over is rejected.
void Remesher::move() {
  for (int v = 0; v < static_cast<int>(x_.size()); ++v) {
    if (table_.out[v] < 0 || table_.is_ghost(v) || (is_rim(v) && !rules_.rims_in_plane)) continue;
    Vec3 target = Vec3::Zero(), normal = Vec3::Zero();
    double weights = 0.0, reach = 0.0;
    table_.around(v, [&](int h) {
      const int a = table_.to(h), b = table_.opposite(h);
      if (table_.is_ghost(a)) return;
      reach = std::max(reach, (x_[a] - x_[v]).norm());
      if (is_rim(v)) {
        if (table_.on_rim(h)) target += x_[a], weights += 1.0;
        return;
      }
      const Vec3 area = area_vector(h);
      const double weight = area.norm() / (size_[a] * size_[b]);
      normal += area;
      target += weight / 3.0 * (x_[v] + x_[a] + x_[b]);
      weights += weight;
    });
    if (weights <= 0.0) continue;
    Vec3 step = target / weights - x_[v];
    if (!is_rim(v)) {
      normal.normalize();
      step -= normal.dot(step) * normal;
    }
    Vec3 goal = x_[v] + 0.8 * step;
    if (is_rim(v)) goal.x() = 0.0;
    place(v, on_surface(goal, is_rim(v), 0.25 * reach));
  }
}

/// Moves vertex v to `goal` unless a face would turn over or half a body would reach across its plane.
void Remesher::place(int v, const Vec3& goal) {
  bool fine = is_rim(v) || !rules_.rims_in_plane || goal.x() > 0.0;
  table_.around(v, [&](int h) {
    const int a = table_.to(h), b = table_.opposite(h);
    if (table_.is_ghost(a) || table_.is_ghost(b)) return;
    const Vec3 after = (x_[a] - goal).cross(x_[b] - goal), before = (x_[a] - x_[v]).cross(x_[b] - x_[v]);
    if (after.dot(before) < 0.3 * after.norm() * before.norm()) fine = false;
  });
  if (!fine) return;
  x_[v] = goal;
  size_[v] = size_at(goal);
}

void Remesher::project() {
  for (int v = 0; v < static_cast<int>(x_.size()); ++v) {
    if (table_.out[v] < 0 || table_.is_ghost(v) || (is_rim(v) && !rules_.rims_in_plane)) continue;
    place(v, on_surface(x_[v], is_rim(v), 0.1 * (x_[table_.to(table_.out[v])] - x_[v]).norm()));
  }
}

void Remesher::round(double edge) {
  split_long(edge);
  flip_by_angle();
  collapse_short(edge);
  flip_by_valence();
  move();
}

void Remesher::delaunay() {
  for (int pass = 0; pass < 200; ++pass)
    if (flip_by_angle() == 0) return;
}

void Remesher::settle(int rounds) {
  for (int i = 0; i < rounds; ++i) {
    flip_by_angle();
    move();
  }
  flip_by_angle();
  project();
}

void Remesher::trim(double edge, int vertices) {
  for (int pass = 0; pass < 20; ++pass) {
    const int now = count(), least = rules_.rims_in_plane ? 2 : 1;
    if (std::abs(now - vertices) < least) return;
    const bool split = now < vertices;
    std::vector<std::pair<double, int>> order;
    for (int h = 0; h < static_cast<int>(table_.origin.size()); ++h)
      if (real(h) && h < table_.twin[h]) order.emplace_back(split ? -relative(h) : relative(h), h);
    std::sort(order.begin(), order.end());
    int requested = std::abs(now - vertices) / least;
    for (const auto& [length, h] : order) {
      if (requested == 0) break;
      if (!real(h) || std::abs(relative(h) - std::abs(length)) > 1e-12) continue;  // changed in this pass
      if (split ? try_split(h) : try_collapse(h, 1.6 * edge) || try_collapse(table_.twin[h], 1.6 * edge))
        --requested;
    }
    flip_by_valence();
    move();
  }
}

TriMesh Remesher::result() const {
  TriMesh mesh;
  std::vector<int> number(x_.size(), -1);
  int n = 0;
  for (std::size_t v = 0; v < x_.size(); ++v)
    if (table_.out[v] >= 0 && !table_.is_ghost(static_cast<int>(v))) number[v] = n++;
  mesh.vertices.resize(3, n);
  for (std::size_t v = 0; v < x_.size(); ++v)
    if (number[v] >= 0) mesh.vertices.col(number[v]) = x_[v];
  std::vector<int> kept;
  for (int h = 0; h < static_cast<int>(table_.origin.size()); h += 3)
    if (!table_.gone(h) && !table_.is_ghost(table_.from(h)) && !table_.is_ghost(table_.to(h)) &&
        !table_.is_ghost(table_.opposite(h)))
      kept.push_back(h);
  mesh.faces.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t f = 0; f < kept.size(); ++f)
    for (int k = 0; k < 3; ++k)
      mesh.faces(k, static_cast<Eigen::Index>(f)) = number[table_.origin[kept[f] + k]];
  return mesh;
}

}  // namespace palpate::shapes
