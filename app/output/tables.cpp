// SPDX-License-Identifier: Apache-2.0
#include "app/output/tables.hpp"

#include <initializer_list>

#include "app/output/text.hpp"

namespace sunder::app {
namespace {

std::string row(std::initializer_list<std::string> cells) {
  std::string line;
  for (const std::string& cell : cells) line += cell + ',';
  line.back() = '\n';
  return line;
}

std::string known(const std::optional<double>& value) {
  return value ? number(*value) : std::string();
}

/// Empty without a device clock.
std::string gpu_time(const StepReport& report, const std::string& pass) {
  if (report.passes.empty()) return {};
  double sum = 0;
  for (const PassTime& time : report.passes) {
    if (pass == time.pass) sum += time.milliseconds;
  }
  return number(sum);
}

}  // namespace

std::string events_header() {
  return "step,event,element,criterion,crack,ratio,load_factor,"
         "tip,K,K_a,K_b,K_c,theta_deg,r,sigma0,beta_deg,a,b,K_I,K_II,"
         "K_III,K_formula,theta_formula_deg,K_field,theta_field_deg,field_note,advance,energy\n";
}

std::string events_row(const DestroyedElement& record) {
  const auto sif = [&](double value) { return record.sif ? number(value) : std::string(); };
  const SifTerms k = record.sif.value_or(SifTerms{});
  return row({std::to_string(record.step),
              std::to_string(record.event),
              record.element == kNone ? "" : std::to_string(record.element),
              to_string(record.cause),
              record.crack == kNone ? "" : std::to_string(record.crack),
              record.ratio ? number(*record.ratio) : "",
              number(record.load_factor),
              record.sif ? std::to_string(k.tip) : "",
              sif(k.k),
              sif(k.k_a),
              sif(k.k_b),
              sif(k.k_c),
              sif(k.theta),
              k.toughness ? "" : sif(k.reach),
              sif(k.sigma0),
              sif(k.beta),
              sif(k.a),
              sif(k.b),
              known(k.k_1),
              known(k.k_2),
              known(k.k_3),
              known(k.k_formula),
              known(k.theta_formula),
              known(k.k_field),
              known(k.theta_field),
              std::string(k.field_note),
              sif(k.advance),
              known(record.energy)});
}

namespace {

std::string of_motion(const std::optional<MotionState>& motion) {
  constexpr std::size_t kColumns = 8;
  if (!motion) return std::string(kColumns, ',');
  std::string line;
  for (double x :
       {motion->time, motion->kinetic, motion->strain_energy, motion->work, motion->dissipated(),
        motion->momentum.x(), motion->momentum.y(), motion->momentum.z()}) {
    line += "," + number(x);
  }
  return line;
}

}  // namespace

std::string frames_header() {
  std::string line =
      "step,load_factor,events,destroyed,compliance,residual,error,max_yield_ratio,"
      "ms_load,ms_solve,ms_stress,ms_decide,ms_update,ms_total,iterations";
  for (const char* pass : kPasses) line += std::string(",ms_gpu_") + pass;
  return line +
         ",strain_max,rotation_max_deg,inverted,back_solves,time,kinetic,strain_energy,work,"
         "dissipated,momentum_x,momentum_y,momentum_z\n";
}

std::string frames_row(const StepReport& report) {
  const StageTimes& ms = report.times;
  std::string line =
      row({std::to_string(report.step), number(report.load_factor), std::to_string(report.events),
           std::to_string(report.destroyed), number(report.compliance), number(report.residual),
           number(report.error), number(report.max_yield_ratio), number(ms.load), number(ms.solve),
           number(ms.stress), number(ms.decide), number(ms.update), number(ms.total),
           std::to_string(report.iterations)});
  line.pop_back();
  for (const char* pass : kPasses) line += "," + gpu_time(report, pass);
  const auto& d = report.deformation;
  line += d ? "," + number(d->strain) + "," + number(d->rotation_deg) + "," +
                  std::to_string(d->inverted)
            : ",,,";
  line += "," + std::to_string(report.back_solves);
  return line + of_motion(report.motion) + "\n";
}

std::string tips_header() {
  return "step,crack,tip,x,y,z,K,theta_deg,K_I,K_II,K_III,J,toughness,field_note\n";
}

std::string tips_row(int step, const TipState& tip) {
  return row({std::to_string(step), std::to_string(tip.crack), std::to_string(tip.tip),
              number(tip.position.x()), number(tip.position.y()), number(tip.position.z()),
              known(tip.k), known(tip.theta), known(tip.k_1), known(tip.k_2), known(tip.k_3),
              known(tip.j), known(tip.toughness), std::string(tip.field_note)});
}

}  // namespace sunder::app
