#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/render/camera.h"
#include "palpate/render/colour_map.h"
#include "palpate/render/picture.h"

namespace palpate::render {

/// One triangle surface at its current positions.
struct Surface {
  std::string name;  ///< shown beside its colour where it has no values; empty: not shown
  Points points;     ///< world [m]
  Faces faces;
  /// one a point, coloured by the scene's scale; NaN: plain; empty: the whole surface is plain
  VecX values = {};
  Rgb colour = {0.62f, 0.66f, 0.71f};  ///< where it is plain
  double opacity = 1.0;                ///< below 1: what is behind shows through
  double crease_deg = 40.0;            ///< edges sharper than this stay sharp
  bool subject = false;                ///< what a picture is about, and should show (seen.h)
};

/// A horizontal plane with a grid; it takes the shadows.
struct Ground {
  double z = 0.0;        ///< [m]
  double spacing = 0.0;  ///< of the grid [m]; 0: a round number that fits the scene
};

/// What a picture shows.
struct Scene {
  std::vector<Surface> surfaces;
  std::optional<Ground> ground = {};
  ColourScale scale = {};
  std::string title = {}, subtitle = {};
};

struct Options {
  int width = 1200, height = 900;  ///< pixels
  int supersampling = 2;           ///< samples along a pixel's edge: 2 is 4 samples a pixel
  View view = {};
  std::optional<Camera> camera = {};  ///< instead of one that frames the scene
  /// Points that the camera frames instead of the scene's: a part of it; or all places where it will be, so
  /// that pictures of several instants fit each other.  Empty: the scene's own.
  Points frame = {};
  bool lit = true;        ///< false: flat colours, no light, no shadow
  bool annotated = true;  ///< title, colour scale and names
  Rgb background = {0.968f, 0.973f, 0.980f};
};

/// Draws the scene on the GPU (or Mesa's software rasteriser) and writes titles and scale beside it.  Counts
/// "render.picture". The calling thread takes the GL context.  Two lights fixed to the camera, smooth
/// normals, soft shadows. Throws Error when a surface's faces point outside its points, a size does not fit,
/// or there is nothing to show.
Picture draw(const Scene& scene, const Options& options = {});

}  // namespace palpate::render
