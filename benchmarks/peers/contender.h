#pragma once
#include <memory>
#include <string>
#include <vector>

#include "motion.h"

namespace peers {

/// Result of a query, evaluated after it, outside the measured time.
struct Found {
  long contacts = 0;     ///< Samples, triangle pairs or vertices, as counted by the contender.
  double deepest = 0.0;  ///< Penetration depth as defined by the contender [m].
};

/// One way to find contact between two deforming skins.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual std::string group() const = 0;  ///< Library: only its fastest way is compared.
  virtual std::string name() const = 0;
  /// Performs one query, from positions of nodes to contacts.
  virtual void query(const Snapshot& state) = 0;
  virtual Found found() const = 0;
};

using Contenders = std::vector<std::unique_ptr<Contender>>;

/// Adds palpate by images.
void add_image(const Motion& motion, Contenders& to);
/// Adds palpate by exact nearest points.
void add_distance(const Motion& motion, Contenders& to);
void add_gimpact(const Motion& motion, Contenders& to);
void add_fcl(const Motion& motion, Contenders& to);
void add_cgal(const Motion& motion, Contenders& to);
/// Adds the common first stage of the other libraries: the two skins' vertices from the nodes.
void add_skins_alone(const Motion& motion, Contenders& to);

}  // namespace peers
