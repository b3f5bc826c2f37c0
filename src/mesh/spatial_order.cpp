#include "mesh/spatial_order.h"

#include <algorithm>
#include <numeric>

#include "palpate/core/error.h"

namespace palpate::mesh {
namespace {

constexpr int kFew = 8;

}  // namespace

void cut_across_longest(const Points& points, std::vector<int>& order, int begin, int end, int middle) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (int k = begin; k < end; ++k) {
    low = low.cwiseMin(points.col(order[static_cast<std::size_t>(k)]));
    high = high.cwiseMax(points.col(order[static_cast<std::size_t>(k)]));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int a, int b) {
    const double pa = points(axis, a), pb = points(axis, b);
    return pa < pb || (pa == pb && a < b);
  });
}

void spatial_order(const Points& points, std::vector<int>& order, int begin, int end) {
  if (end - begin <= kFew) {
    std::sort(order.begin() + begin, order.begin() + end);
    return;
  }
  const int middle = begin + (end - begin) / 2;
  cut_across_longest(points, order, begin, end, middle);
  spatial_order(points, order, begin, middle);
  spatial_order(points, order, middle, end);
}

std::vector<int> spatial_order(const Points& points) {
  std::vector<int> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  spatial_order(points, order, 0, static_cast<int>(order.size()));
  return order;
}

void renumber_nodes(TetMesh& mesh, const std::vector<int>& order) {
  PALPATE_CHECK(static_cast<Eigen::Index>(order.size()) == mesh.nodes.cols(), "{} of {} nodes are renumbered",
                order.size(), mesh.nodes.cols());
  std::vector<int> number(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  mesh.nodes = Points(mesh.nodes(Eigen::all, order));
  mesh.tets = mesh.tets.unaryExpr([&](int node) { return number[static_cast<std::size_t>(node)]; }).eval();
}

}  // namespace palpate::mesh
