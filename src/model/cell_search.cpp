#include "cell_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manifold.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/quality.h"

// A bound c on circumradii gives N = k V / c^3 tetrahedra and edges of about 1.3 c, where k is about 5 and
// depends on the shape.  Each mesh gives a new estimate of k, and the next bound is c <- c (N /
// target)^(1/3), or c <- c target / found for edges.  Optimisation removes a few per cent of the cells
// (exuded slivers), a share that hardly depends on c: it is estimated at first, measured afterwards. If a
// number of nodes is requested too, facets of size s are refined independently of cells.  On a slender body
// nearly all nodes are boundary nodes: their number scales as s^-1.3 and hardly with c, and coarser cells
// leave fewer nodes inside, which raises nodes per tetrahedron by about c^0.2 (measured on a standing human
// figure: 0.1 to 0.3).
namespace palpate::model {
namespace {

constexpr double kCellsPerVolume = 5.0, kEdgePerCell = 1.3, kLeftByOptimising = 0.957;
constexpr double kTolerance = 0.03;
constexpr int kLargestNumber = 20'000'000;

/// Deviation of a mesh from the target, as the factor on the cell size that would correct it.
struct Aim {
  const TetrahedraOptions& options;
  double left = kLeftByOptimising;  ///< share of the cells that remain after optimisation

  bool by_size() const { return options.element_size_m > 0; }
  double correction(const CellCount& found, double share) const {
    if (by_size()) return options.element_size_m / found.mean_edge;
    return std::cbrt(std::max(found.tetrahedra, 1) * share / options.tetrahedra);
  }
  /// Returns the relative error of the number, or of the edge length.
  double error(const CellCount& found, double share) const {
    return by_size() ? std::abs(found.mean_edge / options.element_size_m - 1)
                     : std::abs(found.tetrahedra * share / options.tetrahedra - 1);
  }
};

CellCount count_of(const TetMesh& mesh) {
  double edges = 0;
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t)
    for (const auto& [i, j] : mesh::kTetEdges)
      edges += (mesh.nodes.col(mesh.tets(i, t)) - mesh.nodes.col(mesh.tets(j, t))).norm();
  return {static_cast<int>(mesh.tets.cols()), static_cast<int>(mesh.nodes.cols()),
          edges / (6.0 * std::max<double>(static_cast<double>(mesh.tets.cols()), 1.0))};
}

/// Sizes of cells and facets, and their correction from the counts of a mesh.
struct Sizes {
  const TetrahedraOptions& options;
  double cell, facet, largest;

  bool by_nodes() const { return options.nodes > 0 && options.element_size_m <= 0; }
  double node_error(const CellCount& found) const {
    return by_nodes() ? std::abs(static_cast<double>(found.nodes) / options.nodes - 1) : 0.0;
  }
  /// @param left  share of the tetrahedra found that remain after optimisation
  void correct(const Aim& aim, const CellCount& found, double left) {
    if (!by_nodes()) {
      cell = facet = std::min(cell * std::clamp(aim.correction(found, left), 0.4, 2.5), largest);
      return;
    }
    constexpr double kNodesByFacet = 1.3, kRatioByCell = 0.2, kLargestStep = 0.4;
    const auto step = [&](double x) { return std::exp(std::clamp(x, -kLargestStep, kLargestStep)); };
    facet *= step(std::log(static_cast<double>(std::max(found.nodes, 1)) / options.nodes) / kNodesByFacet);
    const double requested = static_cast<double>(options.nodes) / options.tetrahedra,
                 ratio = std::max(found.nodes, 1) / (std::max(found.tetrahedra, 1) * left);
    cell = std::clamp(cell * step(std::log(requested / ratio) / kRatioByCell), 0.5 * facet, 6.0 * facet);
  }
};

void check(const TetrahedraOptions& options, double volume) {
  constexpr double kPointsPerCell = 0.2;
  if (options.element_size_m != 0 && !(options.element_size_m > 0 && std::isfinite(options.element_size_m)))
    fail("--element-size-m {} must be positive", options.element_size_m);
  if (options.element_size_m == 0 && (options.tetrahedra < 20 || options.tetrahedra > kLargestNumber))
    fail("--tetrahedra {} must lie in [20, {}]", options.tetrahedra, kLargestNumber);
  if (options.element_size_m > 0)
    if (const double number = kCellsPerVolume * volume / std::pow(options.element_size_m / kEdgePerCell, 3);
        number > kLargestNumber || number < 20)
      fail(
          "--element-size-m {} gives about {:.2g} tetrahedra in {:.4g} m^3, must give between 20 and {}; "
          "check the unit of length, which --scale changes",
          options.element_size_m, number, volume, kLargestNumber);
  const double requested = options.element_size_m > 0
                               ? kCellsPerVolume * volume / std::pow(options.element_size_m / kEdgePerCell, 3)
                               : options.tetrahedra;
  if (kPointsPerCell * requested > options.limits.points)
    fail("{:.3g} tetrahedra have about {:.3g} points, more than the limit of {}; raise it with --points",
         requested, kPointsPerCell * requested, options.limits.points);
}

/// Optimises; if a stage fails, remakes the mesh of these sizes and optimises it without that stage.
void optimised(CellMesher& mesher, double cell, double facet, const Progress& progress) {
  constexpr int kStages = 2;
  for (int failed = 0;; ++failed) try {
      return mesher.optimise(progress);
    } catch (const OptimisationFailed&) {
      PALPATE_CHECK(failed < kStages, "{} stages of {} failed", failed + 1, kStages);
      mesher.refine(cell, facet, {});
    }
}

/// Estimates the number of tetrahedra that a sheet of thickness t needs.
double least_number(double volume, double thickness) {
  return thickness > 0 ? kCellsPerVolume * volume / (thickness * thickness * thickness) : 0.0;
}

/// History of the attempts of a search.
class Attempts {
 public:
  explicit Attempts(const TetrahedraOptions& options) : options_(options) {}

  /// @returns false if more attempts are futile: larger cells gave no fewer tetrahedra, and still too many
  bool add(double cell, const CellCount& found) {
    constexpr double kLarger = 1.1, kAsMany = 0.95, kTooMany = 1.3;
    const bool by_number = options_.element_size_m <= 0 && options_.nodes == 0 && !options_.at_least;
    const bool in_vain = by_number && last_cell_ > 0 && cell > kLarger * last_cell_ &&
                         found.tetrahedra > kAsMany * last_ &&
                         found.tetrahedra > kTooMany * options_.tetrahedra;
    const auto distance = [&](int number) { return std::abs(number - options_.tetrahedra); };
    if (last_cell_ == 0 || distance(found.tetrahedra) < distance(nearest_)) nearest_ = found.tetrahedra;
    last_cell_ = cell;
    last_ = found.tetrahedra;
    return !in_vain;
  }

  [[noreturn]] void refuse(double volume, double thickness) const {
    const double least = std::max<double>(least_number(volume, thickness), nearest_);
    fail("no mesh of {} tetrahedra within 3 % was found, the nearest has {}; {}", options_.tetrahedra,
         nearest_,
         nearest_ > options_.tetrahedra
             ? fmt::format("elements cannot be larger where the body is thin; set --tetrahedra to {:.2g} or "
                           "more, drop creases with --creases none, or thicken the body",
                           least)
             : std::string("increase --tetrahedra"));
  }

 private:
  const TetrahedraOptions& options_;
  double last_cell_ = 0.0;
  int last_ = 0, nearest_ = 0;
};

/// Removes tetrahedra where the boundary touches itself, with a note.
void part(FittedMesh& made, double volume, std::vector<std::string>& notes) {
  constexpr double kLargestShare = 0.02;
  const ManifoldReport report = make_boundary_manifold(made);
  if (report.taken == 0) return;
  const std::string what = fmt::format(
      "{} tetrahedra, {:.2g} % of the volume, were removed where the boundary touched itself, first at "
      "({:.4g}, {:.4g}, {:.4g}) m",
      report.taken, 100 * report.volume / volume, report.place.x(), report.place.y(), report.place.z());
  if (report.volume > kLargestShare * volume)
    fail("the body is thinner than its elements: {}; increase --tetrahedra, or thicken the body there", what);
  notes.push_back(what);
}

}  // namespace

// Two bounds.  A sheet of thickness t has the area 2 V / t on both its sides.  A tetrahedron with an angle of
// 8 degrees or more between its faces along the sheet has edges up to about t / tan(8 degrees) = 7 t, and a
// triangle of these, with area 0.43 (7 t)^2, represents three tetrahedra through the sheet.
//
// Second, the ball about a point of one side through the corners of its boundary face must not reach the
// other side, or faces join both sides and are split again: circumradii are at most about t, unless a least
// size ends that, and then N = k V / t^3.  (A washer of 2 mm: none below 6,300 tetrahedra; 8,200 by the
// formula.) 2 V / A is less than the thickness of bodies with lateral faces, a third of the edge for a cube:
// only targets far below the bound are rejected.
void refuse_too_thin(const BodySize& size, const Vec3& place, const TetrahedraOptions& options) {
  constexpr double kLongestEdge = 7.0, kTriangle = 0.43, kThrough = 3.0, kTooMany = 2.0, kFarBelow = 4.0;
  check(options, size.volume);
  if (options.element_size_m > 0 || !(size.area > 0)) return;
  const double thickness = size.thickness(),
               flat = kThrough * size.area / 2 / (kTriangle * std::pow(kLongestEdge * thickness, 2)),
               least = least_number(size.volume, thickness);
  const bool exactly = options.nodes == 0 && !options.at_least;
  if (flat <= kTooMany * options.tetrahedra && !(exactly && least > kFarBelow * options.tetrahedra)) return;
  fail(
      "the body is about {:.2g} m thick, with a surface of {:.3g} m^2, at ({:.4g}, {:.4g}, {:.4g}) m and "
      "elsewhere: it needs about {:.2g} tetrahedra; set --tetrahedra to that, or thicken the body",
      thickness, size.area, place.x(), place.y(), place.z(), least);
}

namespace {

/// Refuses a mesh whose number or size of cells is out of tolerance.
void refuse_far_off(const Aim& aim, const CellCount& found, const Attempts& attempts, double volume,
                    const CellMesher& mesher) {
  if (aim.error(found, 1.0) <= kTolerance) return;
  if (aim.by_size())
    fail("no mesh with edges of {} m within 3 % was found, the nearest has {:.4g} m; choose another size",
         aim.options.element_size_m, found.mean_edge);
  attempts.refuse(volume, mesher.thickness());
}

void refuse_other_nodes(const Sizes& sizes, const CellCount& found, const TetrahedraOptions& options) {
  if (sizes.node_error(found) > kTolerance)
    fail("no mesh of {} tetrahedra with {} nodes within 3 % was found, the nearest has {} and {}",
         options.tetrahedra, options.nodes, found.tetrahedra, found.nodes);
}

}  // namespace

Tetrahedra search_cells(CellMesher& mesher, double volume, bool exact, const TetrahedraOptions& options,
                        const Progress& progress) {
  // Relative to the first estimate, if creases may require more than the target number: cells near them stay
  // at their intended size.
  constexpr double kLargestCell = 1.3;
  constexpr double kClose = 0.012;
  constexpr int kRounds = 3;
  const int attempts = options.nodes > 0 ? 16 : 7;
  // Normally there is one round, which gets nine tenths of the progress bar; each further round gets nine
  // tenths of the remainder, so that progress never decreases.
  double begun = 0.0, left_of_bar = 1.0;
  const auto tell = [&](double fraction) {
    if (progress) progress(begun + left_of_bar * fraction);
  };
  check(options, volume);
  Aim aim{options};
  Attempts attempts_made(options);
  Tetrahedra out;
  CellCount last;
  const double guess = aim.by_size() ? options.element_size_m / kEdgePerCell
                                     : std::cbrt(kCellsPerVolume * volume * aim.left / options.tetrahedra);
  Sizes sizes{
      options, guess, guess,
      options.at_least && !aim.by_size() ? kLargestCell * guess : std::numeric_limits<double>::infinity()};
  const auto enough = [&](const CellCount& found, double share) {
    return sizes.cell == sizes.largest && found.tetrahedra * share > options.tetrahedra;
  };
  for (int round = 0; round < kRounds; ++round, begun += 0.9 * left_of_bar, left_of_bar *= 0.1) {
    for (int attempt = 0;; ++attempt) {
      const double from = 0.4 * (1 - 1.0 / (1 + attempt)), to = 0.4 * (1 - 1.0 / (2 + attempt));
      last = mesher.refine(sizes.cell, sizes.facet,
                           [&](double fraction) { tell(from + (to - from) * fraction); });
      ++out.attempts;
      tell(to);
      if (!attempts_made.add(sizes.cell, last)) attempts_made.refuse(volume, mesher.thickness());
      if ((aim.error(last, aim.left) < kClose && sizes.node_error(last) < kClose) || enough(last, aim.left) ||
          attempt + 1 == attempts)
        break;
      sizes.correct(aim, last, aim.left);
    }
    optimised(mesher, sizes.cell, sizes.facet, [&](double fraction) { tell(0.4 + 0.5 * fraction); });
    FittedMesh made = mesher.take();
    std::vector<std::string> notes;
    part(made, volume, notes);
    const CellCount left = count_of(made.mesh);
    const bool met = aim.error(left, 1.0) < 0.8 * kTolerance && sizes.node_error(left) < 0.8 * kTolerance;
    if (met || enough(left, 1.0) || round + 1 == kRounds) {
      if (left.tetrahedra > 0)
        fit_volume(made, mesher, sizes.facet, exact ? std::optional(volume) : std::nullopt);
      out.mesh = std::move(made.mesh);
      out.notes = std::move(notes);
      out.cell_size = sizes.cell;
      last = left;
      break;
    }
    if (!aim.by_size()) aim.left = static_cast<double>(left.tetrahedra) / std::max(last.tetrahedra, 1);
    sizes.correct(aim, left, 1.0);
  }
  const std::vector<std::string> given_up = mesher.notes();
  out.notes.insert(out.notes.begin(), given_up.begin(), given_up.end());
  if (!enough(last, 1.0)) refuse_far_off(aim, last, attempts_made, volume, mesher);
  refuse_other_nodes(sizes, last, options);
  if (progress) progress(1.0);
  return out;
}

}  // namespace palpate::model
