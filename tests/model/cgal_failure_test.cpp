#include "model/cgal_failure.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate::model {
namespace {

TEST(CgalFailure, ReasonIsOneLine) {
  const CGAL::Precondition_exception e("CGAL", "is_closed(mesh)", "file.h", 12, "The mesh\n  is open.\n");
  EXPECT_EQ(reason_of(e), "The mesh is open. (is_closed(mesh))");
  EXPECT_EQ(reason_of(std::runtime_error("no\nmemory")), "no memory");
}

// The message format of Mesh_3 in CGAL 5.5 and 6.0.
TEST(CgalFailure, ReasonHasNoAddresses) {
  const CGAL::Assertion_exception e("CGAL", "", "Refine_facets_3.h", 1504,
                                    "Mesh_3 ERROR: A facet is not in conflict with its refinement point!\n"
                                    "Debugging information:\n"
                                    "  Facet: (0x5604d6ff90b0, 0) = (0 -0.33333333333333326 0.66)\n");
  EXPECT_EQ(reason_of(e), "Mesh_3 ERROR: A facet is not in conflict with its refinement point!");
}

}  // namespace
}  // namespace palpate::model
