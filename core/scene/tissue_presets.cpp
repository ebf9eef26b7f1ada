// SPDX-License-Identifier: Apache-2.0
// The table. Energies of fracture in N/mm are 1/1000 of the literature's J/m^2. `yield` is compared
// with the maximum shear stress, which is half of a pull (method.md 2): half of a tensile strength.
#include "sunder/tissue_presets.hpp"

#include <algorithm>
#include <array>

namespace sunder {
namespace {

constexpr SourcedValue kNearlyIncompressible{
    .45, "soft tissue is nearly incompressible (Fung 1993); lowered for linear tetrahedra"};

constexpr std::string_view kReview =
    "Recent Advances in Soft Biological Tissue Manipulating Technologies 2022 "
    "(doi 10.1186/s10033-022-00767-4), table 2";

constexpr SourcedValue kAorta{
    .43,
    "order of magnitude: thoracic aorta of dogs at 100 mmHg, along its circumference (Bergel "
    "1961)"};
constexpr SourcedValue kAorticYield{
    .07, "half of the radial strength of the media, 140.1 +- 15.9 kPa (Sommer et al. 2008)"};
constexpr SourcedValue kAorticDensity{1.06e-9, "order of magnitude: vessel walls (Duck 1990)"};

constexpr std::array kPresets{
    TissuePreset{
        .name = "aortic-media-axial",
        .tissue = "media of the human abdominal aorta, dissected along its axis",
        .young = kAorta,
        .poisson = kNearlyIncompressible,
        .yield = kAorticYield,
        .toughness = {},
        .energy = SourcedValue{.076, "76 +- 27 J/m^2, peeled along the axis (Sommer et al. 2008)"},
        .density = kAorticDensity},
    TissuePreset{.name = "aortic-media-circumferential",
                 .tissue = "media of the human abdominal aorta, dissected round its circumference",
                 .young = kAorta,
                 .poisson = kNearlyIncompressible,
                 .yield = kAorticYield,
                 .toughness = {},
                 .energy = SourcedValue{.051,
                                        "51 +- 6 J/m^2, peeled along the circumference "
                                        "(Sommer et al. 2008)"},
                 .density = kAorticDensity},
    TissuePreset{.name = "brain-porcine",
                 .tissue = "brain of pigs",
                 .young = SourcedValue{.0025,
                                       "three times the shear modulus of 842 Pa in slow "
                                       "tension (Miller and Chinzei 2002)"},
                 .poisson = kNearlyIncompressible,
                 .yield = {},
                 .toughness = {},
                 .energy = SourcedValue{.005,
                                        "order of magnitude: 1.5 to 8.9 J/m^2, more when cut "
                                        "faster (wire cutting: Terzano et al. 2021)"},
                 .density = SourcedValue{1.04e-9, "order of magnitude: Duck 1990"}},
    TissuePreset{.name = "cornea-porcine",
                 .tissue = "cornea of pigs",
                 .young = SourcedValue{1.33,
                                       "order of magnitude: stroma across its thickness "
                                       "(Hatami-Marbini and Etebu 2013)"},
                 .poisson = kNearlyIncompressible,
                 .yield = SourcedValue{1.85,
                                       "half of a tensile strength of 3.7 MPa (Zeng et al. "
                                       "2001)"},
                 .toughness = {},
                 .energy = SourcedValue{4.4,
                                        "middle of 3,390 to 5,400 J/m^2, trouser tear at two "
                                        "rates (Tonsomboon et al. 2014)"},
                 .density = {}},
    TissuePreset{.name = "fat-porcine",
                 .tissue = "fat under the skin of pigs",
                 .young = SourcedValue{.0016,
                                       "three times the shear modulus of .53 +- .31 kPa "
                                       "(Sims et al. 2010)"},
                 .poisson = kNearlyIncompressible,
                 .yield = {},
                 .toughness = {},
                 .energy = SourcedValue{4.1, "4,100 J/m^2, trouser tear (Comley and Fleck 2010)"},
                 .density = SourcedValue{.92e-9, "order of magnitude: Duck 1990"}},
    TissuePreset{
        .name = "liver-porcine",
        .tissue = "liver of pigs",
        .young = SourcedValue{.0125, "middle of 10 to 15 kPa by indentation (Samur et al. 2007)"},
        .poisson = kNearlyIncompressible,
        .yield = SourcedValue{.02,
                              "order of magnitude: half of the 40 kPa at which human liver "
                              "tears when pulled slowly (Kemper et al. 2010)"},
        .toughness = {},
        .energy = SourcedValue{.13,
                               "middle of 76 to 185 J/m^2 by a needle (Azar and Hayward "
                               "2008); 187 to 225 by a blade, bovine 164 +- 6 (Gokgol et "
                               "al. 2012)"},
        .density = SourcedValue{1.06e-9, "order of magnitude: Duck 1990"}},
    TissuePreset{.name = "muscle-porcine",
                 .tissue = "skeletal muscle of pigs at rest",
                 .young = SourcedValue{.05,
                                       "order of magnitude: tens of kPa when pulled (Takaza "
                                       "et al. 2013)"},
                 .poisson = kNearlyIncompressible,
                 .yield = {},
                 .toughness = {},
                 .energy = SourcedValue{2.1,
                                        "order of magnitude: geometric mean of 550 to 8,000 "
                                        "J/m^2; their authors doubt that it is a toughness "
                                        "(Taylor et al. 2012)"},
                 .density = SourcedValue{1.06e-9, "Mendez and Keys 1960"}},
    TissuePreset{.name = "skin-porcine",
                 .tissue = "skin of pigs",
                 .young = SourcedValue{1.2,
                                       "order of magnitude: initial slope of human skin, 1.18 "
                                       "+- .88 MPa (Ni Annaidh et al. 2012)"},
                 .poisson = kNearlyIncompressible,
                 .yield = SourcedValue{10.8,
                                       "order of magnitude: half of the strength of human "
                                       "skin, 21.6 +- 8.4 MPa (Ni Annaidh et al. 2012)"},
                 .toughness = {},
                 .energy = SourcedValue{20.4, kReview},
                 .density = SourcedValue{1.1e-9, "order of magnitude: Duck 1990"}},
};

std::optional<double> value_of(const std::optional<SourcedValue>& sourced) {
  return sourced ? std::optional(sourced->value) : std::nullopt;
}

}  // namespace

Material TissuePreset::material() const {
  return {.young = young.value,
          .poisson = poisson.value,
          .yield = value_of(yield),
          .density = value_of(density),
          .toughness = value_of(toughness),
          .energy = value_of(energy)};
}

std::span<const TissuePreset> tissue_presets() { return kPresets; }

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const TissuePreset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

const TissuePreset* find_preset(std::string_view name) {
  const auto* found = std::ranges::find(kPresets, name, &TissuePreset::name);
  return found == kPresets.end() ? nullptr : found;
}

}  // namespace sunder
