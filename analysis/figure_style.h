#pragma once

#include <array>
#include <string_view>

namespace pliant::internal {

/// A colour of the figures: in a file, and in a page that is read in the dark.
struct Colour {
  std::string_view name;
  std::string_view light, dark;  ///< #RRGGBB
};

// Okabe & Ito, Color Universal Design (2008): told apart by colour-blind readers and in grey.
inline constexpr Colour kBlue{"blue", "#0072b2", "#4aa8ec"};
inline constexpr Colour kVermillion{"vermillion", "#d55e00", "#ff8f4a"};
inline constexpr Colour kGreen{"green", "#009e73", "#2fcb9d"};
inline constexpr Colour kPurple{"purple", "#cc79a7", "#e79fc8"};
inline constexpr Colour kSky{"sky", "#56b4e9", "#a6dcfa"};
inline constexpr Colour kAmber{"amber", "#e69f00", "#ffc84f"};
inline constexpr Colour kInk{"ink", "#262626", "#e4e6e9"};
inline constexpr Colour kGrey{"grey", "#737373", "#a0a6ad"};
inline constexpr Colour kGrid{"grid", "#d9d9d9", "#3c4248"};

inline constexpr std::array kColours{kBlue,  kVermillion, kGreen, kPurple, kSky,
                                     kAmber, kInk,        kGrey,  kGrid};

/// In the order of curves, by what else is in the panel.
inline constexpr std::array kAlone{kBlue, kVermillion, kGreen, kPurple, kSky, kAmber, kGrey};
inline constexpr std::array kOnTheLeft{kBlue, kGreen, kSky, kPurple};
inline constexpr std::array kOnTheRight{kVermillion, kAmber};

}  // namespace pliant::internal
