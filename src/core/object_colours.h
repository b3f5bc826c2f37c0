#pragma once
#include <array>
#include <string_view>

/// Colours of the objects of a scene, "#rrggbb", the same in pictures, movies, exported files and the pages
/// in a browser. Programs and pages take them from here; none has another table.
namespace palpate::colours {

inline constexpr std::string_view kBody = "#d8d2c6";  ///< A body without values; the low end of kRamp
inline constexpr std::array<std::string_view, 2> kTools = {"#2f6db3",
                                                           "#2a8f6a"};  ///< First hand, all other hands
inline constexpr std::string_view kHandle = "#1f2a44";    ///< Outline of the handle, and its virtual spring
inline constexpr std::string_view kBone = "#f3ecd2";      ///< Bones
inline constexpr std::string_view kObstacle = "#8c99a8";  ///< Obstacles, except a ground

/// Colours of a value from the low end of its range to the high end, evenly spaced, to be interpolated
/// linearly between neighbours: from pale clay over orange and red to dark magenta. Equal steps of value are
/// equal steps of lightness (OKLab L from 0.865 to 0.375), also for readers with a colour deficiency and in
/// greyscale print; the low end is a pale body, not a black one.
inline constexpr std::array<std::string_view, 17> kRamp = {
    "#d8d2c6", "#d4c7af", "#d1bc98", "#d0b080", "#cfa366", "#d0944c", "#d18534", "#d1741c", "#d16106",
    "#cd4f04", "#c73e10", "#bf2d1d", "#b41c28", "#a61133", "#960f3b", "#851040", "#731443"};

/// Returns the colour of the tool of a hand.
/// @param hand  index of the hand, from zero
constexpr std::string_view tool(std::size_t hand) { return kTools[hand == 0 ? 0 : 1]; }

}  // namespace palpate::colours
