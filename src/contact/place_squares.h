#pragma once
#include "contact/carrier.h"

namespace palpate::contact {

/// sum c q q^T of q = (p, 1), its parts apart: four numbers fill a processor's lanes, five do not.
struct PlaceSquares {
  Mat4 second = Mat4::Zero();
  Vec4 first = Vec4::Zero();
  double zero = 0.0;
  void add(double c, const Vec4& p) {
    const Vec4 cp = c * p;
    second.noalias() += cp * p.transpose();
    first += cp;
    zero += c;
  }
  Eigen::Matrix<double, 5, 5> whole() const {
    Eigen::Matrix<double, 5, 5> out;
    out << second, first, first.transpose(), zero;
    return out;
  }
};

}  // namespace palpate::contact
