#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/friction_log.h"
#include "pliant/analysis/report.h"

namespace pliant {

/// What was identified of one joint: its samples, the fit that was chosen, and those it was chosen
/// from.
struct FrictionResult {
  FrictionLog log;
  FrictionFit fit;
  std::vector<FrictionFit> candidates = {};  ///< empty: the model was given
};

/// The fit of a model; without a model all candidates, the one of least BIC first. An offset is
/// estimated only where samples slide in both directions.
std::vector<FrictionFit> FitChosen(const FrictionSamples& samples,
                                   std::optional<FrictionModel> model, FrictionFitOptions options);

/// The same of a joint. One that does not slide enough has a fit of which nothing is identified.
FrictionResult Identified(FrictionLog log, std::optional<FrictionModel> model,
                          FrictionFitOptions options);

/// The torque error over the velocity with the fitted curve, its Coulomb and viscous parts and the
/// band between them and stiction, and below it what is left. RSS fig. 3.
Figure FigureOf(const FrictionResult& result);

Table FrictionTable(const std::vector<FrictionResult>& results);
Table FrictionModels(const std::vector<FrictionResult>& results);

Report FrictionReportOf(const std::vector<FrictionResult>& results, const std::string& logs,
                        const std::string& read);

/// A line for each parameter and each doubt, for a terminal.
std::string FrictionText(const FrictionResult& result);

/// Writes friction.yaml, whole or not at all. Throws Error if the file is there and is not to be
/// written over, or cannot be written; an older one then stays.
void WriteFriction(const FrictionFile& friction, const std::filesystem::path& file,
                   bool force = false);

}  // namespace pliant
