#pragma once
#include <memory>
#include <string>
#include <vector>

#include "motion.h"

namespace peers {

/// What a query found, told after it, outside of the time that is measured.
struct Found {
  long contacts = 0;     ///< samples, triangle pairs or vertices, as the contender counts
  double deepest = 0.0;  ///< penetration depth as the contender measures it [m]
};

/// One way to find contact between two deforming skins.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string group() const = 0;  ///< the library: its fastest way is what counts
  virtual std::string name() const = 0;
  /// From positions of nodes to what it finds.
  virtual void query(const Snapshot& state) = 0;
  virtual Found found() const = 0;
};

using Contenders = std::vector<std::unique_ptr<Contender>>;

/// palpate by images.
void add_image(const Motion& motion, Contenders& to);
/// palpate by exact nearest points.
void add_distance(const Motion& motion, Contenders& to);
void add_gimpact(const Motion& motion, Contenders& to);
void add_fcl(const Motion& motion, Contenders& to);
void add_cgal(const Motion& motion, Contenders& to);
/// What each of the others begins with: the two skins' vertices from the nodes.
void add_skins_alone(const Motion& motion, Contenders& to);

}  // namespace peers
