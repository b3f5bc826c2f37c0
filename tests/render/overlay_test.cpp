#include "render/overlay.h"

#include <gtest/gtest.h>

using namespace palpate;

// In a picture 900 pixels high texts have their design sizes: the label 18, 32 from the edge, on a plate 8
// wider.
TEST(Margins, KeepTheSceneFromUnderTheScale) {
  render::Options options;
  options.width = 1200;
  options.height = 900;
  render::Canvas canvas(render::Picture(16, 16, {}));
  double narrow = 0.0;
  for (const std::string label : {"depth", "displacement", "von Mises stress"}) {
    render::ColourScale scale;
    scale.label = label;
    scale.unit = label == "von Mises stress" ? "Pa" : "m";
    scale.low = 0.0, scale.high = label == "von Mises stress" ? 4e3 : 0.004;
    const std::string text = label + (label == "von Mises stress" ? " [kPa]" : " [mm]");
    const double right = 1200.0 * render::margins_of({}, options, scale).right;
    EXPECT_GE(right, canvas.text_width(text, 18) + 32 + 8) << label;
    EXPECT_GE(right, narrow);
    narrow = right;
  }
  EXPECT_LT(1200.0 * render::margins_of({}, options, std::nullopt).right, 100.0);
  options.annotated = false;
  EXPECT_LT(1200.0 * render::margins_of({}, options, render::ColourScale{}).right, 100.0);
}
