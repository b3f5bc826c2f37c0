#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/core/pose.h"

namespace palpate {

/// What an object must keep to go on later from where it is now, by name, to the last bit.
///
/// One function serves both directions, so that they cannot differ:
///     void archive(Archive& a) { a("x", x_); a("v", v_); a("axis", axis_); }
/// An archive that keeps takes the values; one that gives back sets them, and throws where a value is not
/// there or has another size or kind.
class Archive {
 public:
  /// Numbers, whole numbers, or bytes.
  using Value = std::variant<std::vector<double>, std::vector<std::int64_t>, std::string>;
  /// By full names: "bodies.state.q".
  using Values = std::map<std::string, Value, std::less<>>;

  /// Keeps.
  Archive() = default;
  /// Gives back.  @param values  of one that kept  @param where  what messages begin with: the file
  Archive(Values values, std::string where);
  bool gives_back() const { return gives_back_; }   ///< else it keeps
  const Values& values() const { return values_; }  ///< all that was kept, or is there to be given back
  /// @throws Error where something was kept that nobody asked back
  void check_all_given_back() const;

  /// Names are of this group while the object lives: "limiter.last_time".
  class Group {
   public:
    /// Begins it, within those that live already.
    Group(Archive& archive, std::string_view name) : archive_(archive), before_(archive.prefix_) {
      archive_.prefix_ += name;
      archive_.prefix_ += '.';
    }
    ~Group() { archive_.prefix_ = before_; }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

   private:
    Archive& archive_;
    std::string before_;
  };

  /// One value under a name that is new in its group: a number, a truth value or enumeration, a text, a list
  /// of numbers, a matrix, a rotation, a pose, a twist, a wrench, or an object that can archive itself.
  /// @throws Error where it is to be given back and is not there or does not fit
  void operator()(std::string_view name, double& value) { numbers(name, {&value, 1}); }
  void operator()(std::string_view name, std::string& text);          ///< see above
  void operator()(std::string_view name, std::vector<double>& list);  ///< see above
  /// See above.
  template <class Integer>
  requires(std::integral<Integer> || std::is_enum_v<Integer>) void operator()(std::string_view name,
                                                                              Integer& value) {
    std::int64_t kept = static_cast<std::int64_t>(value);
    integer(name, kept);
    value = static_cast<Integer>(kept);
  }
  /// See above; one without a fixed size gets it.
  template <int Rows, int Columns>
  void operator()(std::string_view name, Eigen::Matrix<double, Rows, Columns>& matrix) {
    if constexpr (Rows == Eigen::Dynamic || Columns == Eigen::Dynamic) {
      const Group group(*this, name);
      Eigen::Index rows = matrix.rows(), columns = matrix.cols();
      (*this)("rows", rows);
      (*this)("columns", columns);
      check_size(name, rows, columns, Rows, Columns);
      matrix.resize(rows, columns);
      numbers("values", {matrix.data(), static_cast<std::size_t>(matrix.size())});
    } else {
      numbers(name, {matrix.data(), static_cast<std::size_t>(matrix.size())});
    }
  }
  void operator()(std::string_view name, Quat& q) { numbers(name, {q.coeffs().data(), 4}); }  ///< see above
  void operator()(std::string_view name, Pose& pose);                                         ///< see above
  void operator()(std::string_view name, Twist& twist);                                       ///< see above
  void operator()(std::string_view name, Wrench& wrench);                                     ///< see above
  /// An object that can archive itself.
  template <class Object>
  requires requires(Object& object, Archive& archive) { object.archive(archive); }
  void operator()(std::string_view name, Object& object) {
    const Group group(*this, name);
    object.archive(*this);
  }
  /// Elements of a sequence whose length is known on both sides; f(element) archives one.
  template <class Sequence, class F>
  void each(std::string_view name, Sequence& sequence, F&& f) {
    std::size_t i = 0;
    for (auto& element : sequence) {
      const Group group(*this, std::string(name) + "." + std::to_string(i++));
      f(element);
    }
  }
  /// Likewise of many small elements, in one list of numbers; visit(f, element) calls f for each member:
  /// numbers, vectors, poses, twists, wrenches.
  template <class Sequence, class Visit>
  void rows(std::string_view name, Sequence& sequence, Visit&& visit) {
    std::vector<double> all;
    std::size_t next = 0;
    const auto number = [&](auto& value) {
      if (!gives_back_)
        all.push_back(static_cast<double>(value));
      else if (next < all.size())
        value = static_cast<std::remove_reference_t<decltype(value)>>(all[next]);
      ++next;
    };
    if (gives_back_) all = given<std::vector<double>>(name);
    for (auto& element : sequence) visit([&](auto& member) { each_number(number, member); }, element);
    if (!gives_back_) return keep(name, std::move(all));
    check_count(name, all.size(), next);
  }
  /// A sequence that gets its length from here; of elements that can be made of nothing.
  template <class Sequence, class F>
  void list(std::string_view name, Sequence& sequence, F&& f) {
    std::size_t size = sequence.size();
    (*this)(std::string(name) + ".size", size);
    check_length(name, static_cast<std::int64_t>(size));
    sequence.resize(size);
    each(name, sequence, f);
  }
  /// Numbers whose count both sides know.
  void numbers(std::string_view name, std::span<double> values);
  /// A plain record as it lies in memory: for the same program alone.
  template <class Record>
  requires std::is_trivially_copyable_v<Record>
  void bytes(std::string_view name, Record& record) {
    raw(name, {reinterpret_cast<char*>(&record), sizeof(Record)});
  }

 private:
  void integer(std::string_view name, std::int64_t& value);
  void raw(std::string_view name, std::span<char> bytes);
  template <class F, class T>
  static void each_number(F&& f, T& member) {
    if constexpr (std::is_arithmetic_v<T>) {
      f(member);
    } else if constexpr (std::is_same_v<T, Pose>) {
      each_number(f, member.rotation.coeffs());
      each_number(f, member.translation);
    } else if constexpr (std::is_same_v<T, Twist>) {
      each_number(f, member.angular);
      each_number(f, member.linear);
    } else if constexpr (std::is_same_v<T, Wrench>) {
      each_number(f, member.moment);
      each_number(f, member.force);
    } else {
      for (Eigen::Index i = 0; i < member.size(); ++i) f(member.data()[i]);
    }
  }
  void check_count(std::string_view name, std::size_t kept, std::size_t wanted) const;
  void check_length(std::string_view name, std::int64_t size) const;
  void check_size(std::string_view name, Eigen::Index rows, Eigen::Index columns, int fixed_rows,
                  int fixed_columns) const;
  std::string full(std::string_view name) const { return prefix_ + std::string(name); }
  void keep(std::string_view name, Value value);
  const Value& given_value(std::string_view name);
  template <class T>
  const T& given(std::string_view name) {
    const T* value = std::get_if<T>(&given_value(name));
    if (!value) refuse_kind(name);
    return *value;
  }
  [[noreturn]] void refuse_kind(std::string_view name) const;

  Values values_;
  std::map<std::string, bool, std::less<>> asked_;
  std::string prefix_, where_;
  bool gives_back_ = false;
};

}  // namespace palpate
