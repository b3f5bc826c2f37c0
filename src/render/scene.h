#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/object_colours.h"
#include "palpate/core/types.h"
#include "render/camera.h"
#include "render/colour_map.h"
#include "render/picture.h"

namespace palpate::render {

/// Triangle surface at its current positions.
struct Surface {
  std::string name;  ///< Legend entry for a surface without values; empty: none.
  Points points;     ///< World [m].
  Faces faces;
  /// One value per point, coloured by the scene's scale; NaN: plain colour; empty: the whole surface is
  /// plain.
  VecX values = {};
  Rgb colour = colour_of(colours::kBody);  ///< Plain colour.
  double opacity = 1.0;                    ///< Below 1: translucent.
  double crease_deg = 40.0;                ///< Edges sharper than this are not smoothed [degrees].
  bool casts_shadow = true;
  bool subject = false;  ///< Whether the surface is a subject that the view should show (seen.h).
};

/// Horizontal plane with a grid; receives shadows.
struct Ground {
  double z = 0.0;        ///< Height [m].
  double spacing = 0.0;  ///< Spacing of the grid [m]; 0: a round number that fits the scene.
};

/// Content of a picture.
struct Scene {
  std::vector<Surface> surfaces;
  std::optional<Ground> ground = {};
  ColourScale scale = {};
  std::string title = {}, subtitle = {};
};

/// Size, view and style of a picture.
struct Options {
  int width = 1200, height = 900;  ///< pixels
  int supersampling = 2;           ///< Samples along a pixel's edge: 2 means 4 samples per pixel.
  View view = {};
  std::optional<Camera> camera = {};  ///< Replaces the camera that frames the scene.
  /// Points that the camera frames instead of the scene's: a part of it, or its positions over time, so that
  /// pictures of several times have one camera.  Empty: the scene's points.
  Points frame = {};
  bool lit = true;        ///< False: flat colours, no light, no shadow.
  bool annotated = true;  ///< Title, colour bar and names.
  Rgb background = {0.968f, 0.973f, 0.980f};
};

/// Draws the scene on the GPU (or Mesa's software rasteriser), with titles and colour bar.  Two lights fixed
/// to the camera, smooth normals, soft shadows.  Makes the GL context current on the calling thread.  Counts
/// "render.picture".
/// @throws Error when a face refers to a missing point, a value is not finite, a size does not fit, or there
///   is nothing to show
Picture draw(const Scene& scene, const Options& options = {});

}  // namespace palpate::render
