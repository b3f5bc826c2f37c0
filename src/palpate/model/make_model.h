#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh/skeleton.h"
#include "palpate/model/angle_price.h"
#include "palpate/model/foreign_files.h"
#include "palpate/model/quality_gate.h"
#include "palpate/model/regions.h"
#include "palpate/model/repair.h"
#include "palpate/model/tetrahedralise.h"
#include "palpate/store/model_file.h"

namespace palpate::model {

/// What is to become a model.
struct Input {
  std::string name;    ///< of the model
  std::string source;  ///< file without its folder, or the name of a shape: stands in the record
  std::string source_hash;
  std::string format;
  mesh::Provenance from;
  std::vector<std::string> notes;       ///< about what was read, for the outcome
  TriMesh surface;                      ///< is mended, then filled; empty where there are tetrahedra
  TetMesh tets;                         ///< taken as they are, unless remesh
  std::vector<MaterialRegion> regions;  ///< of the tetrahedra
  bool sound = false;                   ///< the surface is known to bound a body: it is not mended
  TriMesh skin;                         ///< the surface that is seen; empty: the mended one
  std::vector<Polyline> creases;
  Skeleton skeleton;
};
Input input_of_file(const std::string& path);

enum class Creases { kAuto, kNone, kAngle };

struct Options {
  double scale = 1.0;  ///< on every coordinate, first
  RepairOptions repair;
  TetrahedraOptions tetrahedra;
  Creases creases = Creases::kAuto;
  double crease_deg = 0.0;  ///< of kAngle
  /// tetrahedra of a file: keep their boundary only, and fill it anew
  bool remesh = false;
  /// tetrahedra of a file: take them whatever their angles, with the price in Made::angle_price
  bool accept_angles = false;
  std::vector<RegionSource> regions;                 ///< beside those of a file of tetrahedra
  int proxies = 60;                                  ///< convex hulls wanted; 0: none
  double bone_margin_m = 0.0;                        ///< nodes nearer to a bone than this belong to it
  std::optional<double> smallest_dihedral_deg = {};  ///< of the gate; nothing: 8, or 4 where creases are kept
};

struct Step {
  std::string name;
  double seconds = 0.0;
};

/// Hears how the work goes on, and sees what each step made.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void begin(const std::string& /*step*/) {}
  virtual void progress(double /*fraction*/) {}        ///< of the step
  virtual void stage(const std::string& /*stage*/) {}  ///< a part of the step begins
  virtual void point(const Vec3& /*place*/) {}         ///< that the work is at, many times a second
  virtual void place(const std::string& /*where*/) {}  ///< that a long piece of the step works at
  virtual void end(const Step& /*step*/) {}
};

struct Made {
  store::ModelFile file;
  TetQuality quality;
  std::vector<RegionFigures> regions;
  bool creased = false;
  std::optional<AnglePrice> angle_price;  ///< where accept_angles took a mesh that the gate refuses
  std::vector<Step> steps;
};

/// A layered model of a surface, step by step: mend, fill with tetrahedra, check, name regions, embed the
/// skin, bind the skeleton, cut into convex proxies. The same input and options give the same model, to the
/// last bit. options.tetrahedra.limits bounds the time of all steps together: it is looked at between steps
/// and while the surface is filled. Mending cannot be interrupted; `palpate model` ends its own process when
/// the time is over.
/// @throws Error where a step cannot do its work, or the tetrahedra do not pass the gate
Made make_model(Input input, const Options& options, Watcher& watcher);

}  // namespace palpate::model
