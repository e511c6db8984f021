#include "scans/join.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::scans {
namespace {

constexpr std::size_t kFitsPerPair = 8;
constexpr std::size_t kBeam = 12;
constexpr std::size_t kLookedUp = 500;
// A scan that joins shares so much of its points with one of the others, and contradicts all of them by no more.
constexpr double kLeastShared = 0.06;
constexpr double kMostContradicting = 0.03;
// A combination that reaches this share of the best one's merit is as likely.
constexpr double kSecondMerit = 0.96;

// How `scan` may lie on `model`.
struct Edge {
  std::size_t model, scan;
  std::vector<Fit> fits;
};

// Some scans in one frame.
struct State {
  std::vector<std::optional<ScanPose>> pose;
  double merit = 0.0;
  std::size_t count = 0;
};

struct Welcome {
  double merit = 0.0;          // of all pairs with those there
  double shared = 0.0;         // greatest with one of them
  double contradicting = 0.0;  // greatest with one of them
};

class Joiner {
 public:
  Joiner(const std::vector<ScanView>& views, std::vector<Edge> edges) : views_(views), edges_(std::move(edges)) {}

  [[nodiscard]] Welcome welcome(const State& state, std::size_t scan, const ScanPose& pose) const {
    Welcome sum;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!state.pose[i] || i == scan) continue;
      AgreementLimits limits = strict_limits(views_[i], views_[scan]);
      limits.points = kLookedUp;
      const Agreement pair = mutual(views_[i], views_[scan], state.pose[i]->inverse() * pose, limits);
      sum.merit += merit(pair);
      sum.shared = std::max(sum.shared, pair.agreeing);
      sum.contradicting = std::max(sum.contradicting, pair.contradicting);
    }
    return sum;
  }

  // All places of `scan` beside those of the state, whether they fit or not.
  template <class Visit>
  void places(const State& state, std::size_t scan, const Visit& visit) const {
    for (const Edge& edge : edges_) {
      const bool forth = edge.scan == scan && state.pose[edge.model].has_value();
      const bool back = edge.model == scan && state.pose[edge.scan].has_value();
      if (!forth && !back) continue;
      for (const Fit& fit : edge.fits)
        visit(forth ? *state.pose[edge.model] * fit.T_model_scan : *state.pose[edge.scan] * fit.T_model_scan.inverse());
    }
  }

  [[nodiscard]] std::vector<State> begin() const {
    std::vector<State> states;
    for (const Edge& edge : edges_) {
      for (const Fit& fit : edge.fits) {
        State state;
        state.pose.resize(views_.size());
        state.pose[edge.model] = ScanPose{};
        state.pose[edge.scan] = ScanPose{fit.T_model_scan.rotation, fit.T_model_scan.translation_mm};
        state.merit = merit(fit.agreement);
        state.count = 2;
        states.push_back(std::move(state));
      }
    }
    return states;
  }

  [[nodiscard]] std::vector<State> grow(const State& state) const {
    std::vector<State> grown;
    for (std::size_t scan = 0; scan < views_.size(); ++scan) {
      if (state.pose[scan]) continue;
      places(state, scan, [&](const ScanPose& pose) {
        const Welcome found = welcome(state, scan, pose);
        if (found.shared < kLeastShared || found.contradicting > kMostContradicting) return;
        State next = state;
        next.pose[scan] = pose;
        next.merit += found.merit;
        ++next.count;
        grown.push_back(std::move(next));
      });
    }
    return grown;
  }

  // Whether two states say the same of the same scans.
  [[nodiscard]] bool alike(const State& a, const State& b) const {
    std::optional<Pose<frame::Part, frame::Part>> between;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (a.pose[i].has_value() != b.pose[i].has_value()) return false;
      if (!a.pose[i]) continue;
      const auto own = *b.pose[i] * a.pose[i]->inverse();
      if (!between) between = own;
      const Vec3 middle = *a.pose[i] * views_[i].point[0].point_mm.cast<double>();
      if ((*between * middle - own * middle).norm() > 0.02 * views_[i].diagonal_mm ||
          rotation_between_rad(between->rotation, own.rotation) > 0.05)
        return false;
    }
    return true;
  }

  void prune(std::vector<State>& states) const {
    std::stable_sort(states.begin(), states.end(), [](const State& a, const State& b) { return a.merit > b.merit; });
    std::vector<State> kept;
    for (State& state : states) {
      if (kept.size() == kBeam) break;
      const auto same = [&](const State& other) { return alike(state, other); };
      if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(std::move(state));
    }
    states = std::move(kept);
  }

  // The best combinations of most scans, best first.
  [[nodiscard]] std::vector<State> search() const {
    std::vector<State> beam = begin();
    prune(beam);
    std::vector<State> best(1);
    best.front().pose.resize(views_.size());
    while (!beam.empty()) {
      best = beam;
      std::vector<State> next;
      for (const State& state : beam) {
        for (State& grown : grow(state)) next.push_back(std::move(grown));
      }
      prune(next);
      beam = std::move(next);
    }
    return best;
  }

  // Whether the surface seen so far looks the same after the motion: then it makes no difference.
  [[nodiscard]] bool symmetric(const State& state, const Pose<frame::Part, frame::Part>& motion) const {
    for (std::size_t i = 0; i < views_.size(); ++i) {
      for (std::size_t j = 0; j < views_.size(); ++j) {
        AgreementLimits limits = strict_limits(views_[i], views_[j]);
        limits.points = kLookedUp;
        const CrossPose T_j_i = state.pose[j]->inverse() * (motion * *state.pose[i]);
        if (look_up(views_[i], views_[j], T_j_i, limits).contradicting > kMostContradicting) return false;
      }
    }
    return true;
  }

  // Notes the other place of a scan, unless it differs by nothing or by a symmetry of the part.
  void note(const State& state, std::size_t scan, const ScanPose& other, std::vector<SecondPlace>& out) const {
    const ScanPose& chosen = *state.pose[scan];
    const Vec3 middle = views_[scan].point[0].point_mm.cast<double>();
    const double turned = rotation_between_rad(other.rotation, chosen.rotation);
    const double shifted = (other * middle - chosen * middle).norm();
    if (turned < rad_from_deg(5.0) && shifted < 0.03 * views_[scan].diagonal_mm) return;
    if (!symmetric(state, other * chosen.inverse())) out.push_back({scan, turned, shifted});
  }

  // Scans that lie elsewhere in another combination of all scans that is almost as good.
  void compare(const State& state, const State& other, std::vector<SecondPlace>& out) const {
    if (other.count < state.count || other.merit < kSecondMerit * state.merit) return;
    const auto T_state_other = *state.pose[0] * other.pose[0]->inverse();
    for (std::size_t scan = 1; scan < views_.size(); ++scan) note(state, scan, T_state_other * *other.pose[scan], out);
  }

 private:
  const std::vector<ScanView>& views_;
  std::vector<Edge> edges_;
};

std::vector<Edge> search_all(const std::vector<ScanView>& views, const std::function<void(int, int)>& done) {
  double size_mm = 0.0;
  for (const ScanView& view : views) size_mm = std::max(size_mm, view.diagonal_mm);
  std::vector<Edge> edges;
  const auto total = static_cast<int>(views.size() * (views.size() - 1) / 2);
  for (std::size_t model = 0; model + 1 < views.size(); ++model) {
    const PairTable table(views[model], size_mm);
    for (std::size_t scan = model + 1; scan < views.size(); ++scan) {
      edges.push_back({model, scan, search_pair(views[model], table, views[scan], kFitsPerPair)});
      if (done) done(static_cast<int>(edges.size()), total);
    }
  }
  return edges;
}

// Why the scan could not be joined to the best state.
std::unexpected<Error> left_out(const std::vector<ScanView>& views, const Joiner& joiner, const State& state,
                                std::size_t scan) {
  Welcome nearest;
  joiner.places(state, scan, [&](const ScanPose& pose) {
    const Welcome found = joiner.welcome(state, scan, pose);
    if (found.shared > nearest.shared) nearest = found;
  });
  if (nearest.shared < kLeastShared) {
    return failure(
        ResultCode::kNothingFound,
        "%s: shares too little surface with the other scans (%zu of %zu joined; at least %.0f %% needed, found "
        "%.0f %%); add scans of the part in positions between this one and the others, or leave it out",
        views[scan].name.c_str(), state.count, views.size(), 100 * kLeastShared, 100 * nearest.shared);
  }
  return failure(ResultCode::kNothingFound,
                 "%s: contradicts the other scans: where it shares most surface with them (%.0f %%), %.0f %% of it "
                 "stands where another saw nothing; is it the same part, and nothing else in view?",
                 views[scan].name.c_str(), 100 * nearest.shared, 100 * nearest.contradicting);
}

}  // namespace

Result<Joined> join(const std::vector<ScanView>& views, const std::function<void(int, int)>& done) {
  if (views.size() == 1) return Joined{{ScanPose{}}, {}};
  const Joiner joiner(views, search_all(views, done));
  const std::vector<State> states = joiner.search();
  const State& best = states.front();
  for (std::size_t scan = 0; scan < views.size(); ++scan) {
    if (!best.pose[scan]) return left_out(views, joiner, best, scan);
  }
  Joined joined;
  const auto T_first_frame = best.pose[0]->inverse();
  for (const std::optional<ScanPose>& pose : best.pose) {
    const CrossPose relative = T_first_frame * *pose;
    joined.T_part_scan.push_back({relative.rotation, relative.translation_mm});
  }
  for (std::size_t i = 1; i < states.size() && joined.seconds.empty(); ++i)
    joiner.compare(best, states[i], joined.seconds);
  return joined;
}

}  // namespace beltpick::scans
