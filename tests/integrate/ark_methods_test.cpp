#include <cstdio>  // SUNDIALS 6.4 forgets it

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <complex>
#include <set>

#include "integrate/sundials/ark_methods.h"

/// What ark_methods.cpp claims of each table, found from the tables of the installed version themselves.
namespace palpate {
namespace {

using Complex = std::complex<double>;

struct Table {
  MatX A;
  VecX b, c;
  int order = 0, embedded = 0;
  explicit Table(ARKodeButcherTable t) {
    const int s = t->stages;
    A.resize(s, s);
    b = Eigen::Map<const VecX>(t->b, s);
    c = Eigen::Map<const VecX>(t->c, s);
    for (int i = 0; i < s; ++i)
      for (int j = 0; j < s; ++j) A(i, j) = t->A[i][j];
    order = t->q;
    embedded = t->p;
    ARKodeButcherTable_Free(t);
  }
  /// R(z) = 1 + z b^T (I - z A)^-1 1
  double amplification(Complex z) const {
    const auto s = A.rows();
    const Eigen::MatrixXcd M = Eigen::MatrixXcd::Identity(s, s) - z * A.cast<Complex>();
    const Eigen::VectorXcd stages = M.partialPivLu().solve(Eigen::VectorXcd::Ones(s));
    return std::abs(1.0 + z * (b.cast<Complex>().transpose() * stages)(0));
  }
  /// With no pole in the left half plane the maximum principle leaves the imaginary axis to look at; poles are at 1 / a_ii > 0.
  bool a_stable() const {
    if (A.diagonal().minCoeff() < 0.0) return false;
    for (double e = -4.0; e < 8.0; e += 0.01)
      if (amplification({0.0, std::pow(10.0, e)}) > 1.0 + 1e-9) return false;
    return true;
  }
  double at_infinity() const { return amplification({-1e8, 0.0}); }
  bool stiffly_accurate() const { return (A.row(A.rows() - 1).transpose() - b).norm() < 1e-12; }
  int stage_order() const {
    int q = 0;
    while (q < 5 && (A * VecX(c.array().pow(q)) - VecX(c.array().pow(q + 1) / (q + 1))).norm() < 1e-10) ++q;
    return q;
  }
};

const std::vector<integrate::ArkMethod>& methods() { return integrate::ark_methods(); }

TEST(ArkMethods, ImplicitTablesAreAsStableAsTheySay) {
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.implicit_table < 0) continue;
    const Table t(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(m.implicit_table)));
    EXPECT_TRUE(t.a_stable()) << m.name;
    EXPECT_EQ(t.at_infinity() < 1e-5, m.traits.stability == dynamics::Stability::kL) << m.name << ": R(-inf) = " << t.at_infinity();
    EXPECT_EQ(t.order, m.traits.order) << m.name;
    EXPECT_EQ(t.embedded, m.embedded_order) << m.name;
    EXPECT_EQ(m.traits.stiff_order, t.stiffly_accurate() ? t.stage_order() : t.stage_order() + 1) << m.name;
    ++checked;
  }
  EXPECT_EQ(checked, 28);
}

TEST(ArkMethods, ExplicitTablesHaveTheirOrder) {
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.explicit_table < 0 || m.implicit_table >= 0) continue;
    const Table t(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(m.explicit_table)));
    EXPECT_EQ(t.order, m.traits.order) << m.name;
    EXPECT_EQ(t.embedded, m.embedded_order) << m.name;
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

TEST(ArkMethods, NoStableTableOfTheInstalledVersionIsMissing) {
  std::set<int> listed;
  for (const auto& m : methods())
    if (m.implicit_table >= 0 && m.explicit_table < 0) listed.insert(m.implicit_table);
  int stable = 0;
  for (int id = ARKODE_MIN_DIRK_NUM; id <= ARKODE_MAX_DIRK_NUM; ++id) {
    const Table t(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(id)));
    if (!t.a_stable()) continue;
    ++stable;
    EXPECT_EQ(listed.count(id), 1u) << "table " << id;
  }
  EXPECT_EQ(stable, 23);
}

}  // namespace
}  // namespace palpate
