#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/angle_cost.h"
#include "model/foreign_files.h"
#include "model/quality_gate.h"
#include "model/regions.h"
#include "model/repair.h"
#include "model/tetrahedralise.h"
#include "palpate/mesh/skeleton.h"
#include "store/model_file.h"

namespace palpate::model {

/// Input of make_model: a surface or tetrahedra, and what was read with them.
struct Input {
  std::string name;    ///< name of the model
  std::string source;  ///< file without its folder, or the name of a shape; is stored in the record
  std::string source_hash;
  std::string format;
  mesh::Provenance from;
  std::vector<std::string> notes;       ///< notes on the reading, for the record
  TriMesh surface;                      ///< mended, then filled; empty if there are tetrahedra
  TetMesh tets;                         ///< used unchanged, unless remesh
  std::vector<MaterialRegion> regions;  ///< regions of the tetrahedra
  bool sound = false;                   ///< true: the surface is known to bound a body and is not mended
  TriMesh skin;                         ///< the visible surface; empty: the mended one
  std::vector<Polyline> creases;
  Skeleton skeleton;
};
/// Reads a file (foreign_files.h) into an Input.
Input input_of_file(const std::string& path);

/// Which edges are kept sharp: detected automatically, none, or all that turn by more than an angle.
enum class Creases { kAuto, kNone, kAngle };

/// Options of make_model.
struct Options {
  double scale = 1.0;                ///< factor on every coordinate, applied first
  Quat rotation = Quat::Identity();  ///< of every coordinate, applied after the factor
  RepairOptions repair;
  TetrahedraOptions tetrahedra;
  Creases creases = Creases::kAuto;
  double crease_deg = 0.0;  ///< for kAngle
  /// For tetrahedra of a file: fill their boundary anew.
  bool remesh = false;
  /// For tetrahedra of a file: accept any angles, and report their cost in Made::angle_cost.
  bool accept_angles = false;
  std::vector<RegionSource> regions;                 ///< in addition to the regions of a file of tetrahedra
  int proxies = 60;                                  ///< target number of convex hulls; 0: none
  double bone_margin_m = 0.0;                        ///< nodes nearer to a bone than this belong to it
  std::optional<double> smallest_dihedral_deg = {};  ///< limit of the gate; nothing: 8, or 4 if creases are
                                                     ///< kept
};

/// Finished step and its wall time.
struct Step {
  std::string name;
  double seconds = 0.0;
};

/// Receives progress reports and the result of each step.
class ProgressListener {
 public:
  virtual ~ProgressListener() = default;
  virtual void begin(const std::string& /*step*/) {}
  virtual void progress(double /*fraction*/) {}        ///< fraction of the step
  virtual void stage(const std::string& /*stage*/) {}  ///< start of a stage within the step
  virtual void point(const Vec3& /*place*/) {}         ///< place of the work [m], many times per second
  virtual void place(const std::string& /*where*/) {}  ///< place of a long operation within the step
  virtual void end(const Step& /*step*/) {}
};

/// Result of make_model.
struct Made {
  store::ModelFile file;
  TetQuality quality;
  std::vector<RegionFigures> regions;
  bool creased = false;
  std::optional<AngleCost> angle_cost;  ///< set if accept_angles accepted a mesh that the gate rejects
  std::vector<Step> steps;
};

/// Builds a layered model step by step: mends the surface, fills it with tetrahedra, checks them, names
/// regions, embeds the skin, binds the skeleton, and cuts the body into convex proxies.  Deterministic: the
/// same input and options give bitwise the same model.  options.tetrahedra.limits bounds the time of all
/// steps together; it is checked between steps and while the surface is filled.  Mending cannot be
/// interrupted; `palpate model` ends the process when the time is over.
/// @throws Error if a step fails, or the tetrahedra do not pass the gate
Made make_model(Input input, const Options& options, ProgressListener& watcher);

}  // namespace palpate::model
