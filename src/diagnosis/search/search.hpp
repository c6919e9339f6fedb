// The search for what explains a mismatch: screening by derivatives, refits side by side, pairs with swaps, more.
#pragma once
#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/search/candidates.hpp"
#include "diagnosis/search/fit.hpp"
#include "diagnosis/search/screening.hpp"
#include "diagnosis/verdict/decision_rules.hpp"

namespace pneuservo {

/// One set of names that was fitted; members are indices of candidates, in ascending order. None: the owner's model.
struct Explanation {
  std::vector<std::size_t> members;
  Fit fit;
  double log_evidence = -1e300;
};

inline std::vector<std::size_t> with_member(std::vector<std::size_t> members, std::size_t added) {
  members.insert(std::upper_bound(members.begin(), members.end(), added), added);
  return members;
}
inline std::vector<std::size_t> without_member(std::vector<std::size_t> members, std::size_t leaving) {
  std::erase(members, leaving);
  return members;
}
inline bool contains(const std::vector<std::size_t>& members, std::size_t index) {
  return std::find(members.begin(), members.end(), index) != members.end();
}

/// Where a search before this one ended with a name.
struct KnownStart {
  std::string name;
  std::vector<double> z;  ///< of the candidate's parameters
};

/// Shares of the progress that a search tells between. Before the first one nothing is known.
struct ProgressSpan {
  double begin, end;
};
/// What is shown of a diagnosis's two searches, the later one beside small physics: 26 and 27 of 54 s where both were
/// timed. It decides nothing.
inline constexpr ProgressSpan first_search{0.05, 0.5}, later_search{0.5, 0.95};

/// How much work a search does.
struct SearchSettings {
  ProgressSpan progress = first_search;
  std::size_t refits = 12;      ///< candidates refitted after the first screening
  std::size_t next_refits = 5;  ///< and after each later one
  std::size_t pairs = 6;        ///< pairs refitted that promise most together
  std::size_t polished = 4;     ///< of each number of effects, fitted to their ends
  double least_gain = 10;       ///< in chi2, to be refitted
  double least_share = 0.02;    ///< of the best gain
  double screened_share = 0.3;  ///< of a further name's gain that its linear screening shows at least
  double rival_distance = 300;  ///< in log evidence: rivals that are fitted as far as the best
  double settled_gain = 0.1;    ///< in chi2: a fit that a step improves by less is at its end
  std::vector<FreeParameter> small_physics;  ///< nuisances beside the tolerances
  std::vector<KnownStart> known_starts;      ///< names refitted from there where the screening leaves them out
  std::vector<std::string> left_out;  ///< effects that are neither tried nor granted
  /// Whether the model's slow error follows what is left: first by the owner's model, then by the best single name,
  /// each compared beside its own.
  bool grow_floor = false;
};

/// Runs once over one model. Every explanation that was refitted is kept.
class Search {
 public:
  using Progress = std::function<void(double share, const std::string& what)>;
  Search(FittedRows& rows, const Rig& rig, std::vector<Candidate> candidates, SearchSettings settings,
         const DecisionRules& rules, Progress progress);

  /// Fills all that follows. May throw DiagnosisStopped: what is there by then is valid.
  void run();
  /// Takes the grid's error at this explanation and fits it to its end there, unless that was done last: the error at
  /// a larger one is another. Returns whether anything was done. May throw DiagnosisStopped.
  bool settle(const Explanation& explanation);

  /// What each name of another search's explanation brings in log evidence beside this search's nuisances. A single
  /// number that the owner has wrong is also taken as that search has it, where that is likelier: a machine may have
  /// nothing small. May throw DiagnosisStopped.
  std::vector<double> gains_of_names(const Explanation& other);
  /// Log evidence of the likeliest explanation with one name fewer than another search's, beside this search's
  /// nuisances and the slow error that it leaves. May throw DiagnosisStopped.
  double best_with_one_fewer(const Explanation& other);
  /// Log evidence beside the slow error that the explanation leaves itself.
  double beside_own_error(const Explanation& explanation);
  /// What each other candidate would gain beside another search's explanation and this search's nuisances, by
  /// derivatives where that one stands, with its size's standard error. May throw DiagnosisStopped.
  std::vector<Screened> screened_at(const Explanation& other);

  const std::vector<Candidate>& candidates() const { return candidates_; }
  bool grants_small_physics() const { return settings_.grow_floor; }
  const std::vector<std::string>& left_out() const { return settings_.left_out; }
  /// What every machine has a little of, but for what is left out.
  std::vector<FreeParameter> small_physics_of_all() const {
    return small_physics(rig_, rows_.model().channels(), settings_.left_out);
  }
  /// Whether the owner's model has the supply's swing at the end of what every supply does.
  bool owner_wants_more_swing() const;
  /// Whether a single name's number stands, in the owner's model, at the end of what is granted there.
  bool owner_wants_more(const Explanation& explanation) const;
  /// The owner's values as they stand, nothing fitted.
  const Fit& as_configured() const { return as_configured_; }
  /// The owner's model with its parameters inside their tolerances.
  const Explanation& owner() const { return owner_; }
  /// All explanations with this many members, best first.
  std::vector<const Explanation*> ranking(std::size_t members) const;
  /// The best of that many members; nullptr where there is none.
  const Explanation* best_of(std::size_t members) const;
  /// The best by effects that are laws; nullptr where there is none.
  const Explanation* best_named(std::size_t members) const;
  /// What its names are before any data, in log evidence; within Explanation::log_evidence.
  double log_prior(const Explanation& explanation) const;
  /// Whether one of its effects is a description (Candidate::is_description).
  bool is_description(const Explanation& explanation) const;
  /// Where the best single names stand that small physics does not mimic, for a search after this one.
  std::vector<KnownStart> best_starts(std::size_t most) const;
  /// Gain of the best single name in log evidence; where the floor grows, of names and owner each beside its own.
  double first_gain() const { return first_gain_; }
  /// What each candidate would gain alone on the owner's fit.
  const std::vector<Screened>& first_screening() const { return first_screening_; }

 private:
  Fit start_fit(const std::vector<std::size_t>& members) const;
  Fit continued_fit(const Fit& base, const std::vector<std::size_t>& members, const std::vector<Screened>& added) const;
  std::vector<std::size_t> others(const std::vector<std::size_t>& members) const;
  std::vector<Screened> worth_refitting(std::vector<Screened> screened, std::size_t count) const;
  void add_known(std::vector<Screened>& chosen) const;
  /// Dead time and lag stand for each other, and a dead time has a valley every sample: fits from afar ended 0.8 ms
  /// beside their own, 300 in chi2 above its floor. Where one of them is the best name each is fitted once more from
  /// the size of the best other; true where one came out better.
  bool restart_siblings();
  /// Fits the best explanation anew from the valleys beside its own; true where one of them is deeper.
  bool move_to_deeper_valley(std::size_t members);
  /// The same until none is deeper, at most as many as the answer to the command is compared over.
  void settle_in_deepest_valley(std::size_t members);
  void refit(const Fit& base, const std::vector<std::size_t>& members, const std::vector<Screened>& chosen);
  void refit(const Fit& base, const std::vector<std::size_t>& members, const std::vector<std::vector<Screened>>& sets);
  /// The screening is linear: a large effect may start better at a part of the size that it says.
  void move_to_best_share(std::vector<Explanation>& attempts, const std::vector<std::vector<Screened>>& starts);
  void add_families(const Fit& base, const std::vector<std::size_t>& members, const std::vector<Screened>& screened);
  double log_evidence(const Explanation& explanation) const;
  /// Which derivatives are taken anew: those by an explanation's own numbers at every step, by the others never or
  /// where the fits begin.
  enum class Anew { own, others_once };
  /// Another search's explanation with each of its names left out in turn, beside this search's nuisances, not yet
  /// fitted.
  std::vector<Explanation> with_one_fewer(const Explanation& other) const;
  void polish_each(std::vector<Explanation>& fitted);
  Columns kept_columns() const { return settings_.small_physics.empty() ? Columns::own : Columns::corrected; }
  void polish(const std::vector<Explanation*>& explanations, int iterations, Anew anew = Anew::others_once);
  /// Fits that began apart may end in different valleys of the tolerances: dry friction and a leak of a chamber, 164 in
  /// chi2 above where the same friction beside a leak of its line stood; offsets of two sensors that are one model, 46
  /// in log evidence apart. The best is fitted once more from where each rival stands in what they share, and each
  /// from the best; those that moved to a better fit.
  std::vector<Explanation*> refit_at_rivals(std::size_t members);
  void polish_rivals(std::size_t members, std::set<const Explanation*>& at_end);
  void polish_best(std::size_t members);
  void take_defect_at_best(std::size_t members);
  void search_singles();
  void refit_owner_at_best();
  void fit_owner();
  void fit_owner_beside_slow_error();
  /// Beside the slow error the supply may swing where a sine of its pressure explains more than chance; true: it may,
  /// and the owner's fit begins anew from where it was.
  bool free_supply_swing();
  bool is_bent() const;
  bool is_everywhere_beside(std::size_t members);
  void take_defect_at_owner();
  /// All of that many names by it, best first.
  std::vector<std::pair<double, Explanation*>> beside_own_errors(std::size_t members);
  /// The best of that many names, the first few fitted beside their own slow errors; nullptr: there is none.
  std::pair<double, Explanation*> best_beside_own_error(std::size_t members);
  void take_floor_at_best();
  /// A second name beside the first, each pair beside its own slow error; nullptr where none brings enough.
  const Explanation* pair_beside(const Explanation& first, double first_evidence);
  bool search_next(std::size_t members);
  /// Fits a part of an explanation's names from where they stand in it, and keeps the better of that and what is known:
  /// names may lead each other out of a valley that one alone ends in.
  void fit_part(const Explanation& whole, const std::vector<std::size_t>& part);
  void swap_members(const Explanation& best);
  void refit_sibling_pairs(const Explanation& best);
  /// Log evidence that counts for one beside what this fit leaves, in its mean square; of a pneumatic rig a second
  /// search grows the floors instead.
  double evidence_scale(const Fit& fit) const;
  std::vector<Explanation*> rivals(std::size_t members, double distance, std::size_t most);
  /// All of that many names that have a fit, best first.
  std::vector<Explanation*> all_tried(std::size_t members);
  void tell(double share, const std::string& what) const;

  FittedRows& rows_;
  Rig rig_;
  std::vector<Candidate> candidates_;
  SearchSettings settings_;
  DecisionRules rules_;
  Progress progress_;
  std::vector<FreeParameter> nuisances_;
  double swing_Hz_ = 0;  ///< of the supply, where it may swing; 0: it may not
  Fit as_configured_;
  Explanation owner_;
  /// Of the owner's model with the grid's error taken at its own fit: taken elsewhere, the error would count against
  /// it.
  double owner_evidence_at_home_ = -1e300;
  double first_gain_ = 0;
  std::map<std::vector<std::size_t>, Explanation> tried_;
  std::vector<Screened> first_screening_;
  std::vector<ScreenedPair> first_pairs_;
  std::vector<std::size_t> working_point_;  ///< members of the explanation where the grid's error was taken last
};

}  // namespace pneuservo
