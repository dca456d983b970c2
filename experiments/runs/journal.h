// What a long study has finished, on disk piece by piece, so that an interrupted one goes on where it was.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/command/options.h"
#include "experiments/command/output.h"

namespace springstab {

/// A study asks for its pieces one after the other, always in the same order. Those that the journal has are
/// taken from it, in the order in which they were written; the others are computed, and appended before the
/// study sees them: a line "hash JSON" each, the first for the run's identity. A last line that a kill has
/// torn is dropped.
class Journal {
 public:
  /// Keeps nothing.
  Journal() = default;
  static Journal& none();

  /// In FOLDER/COMMAND.journal (nowhere if the folder is empty): begins anew, or to resume goes on with what
  /// is there, and tells Ctrl-C and, unless `quiet`, the user what that is. Throws InputError for a journal
  /// that is there undecided (expect_decided), of another run or damaged, if the file cannot be written or
  /// another process uses the folder, and for --resume without a folder.
  Journal(const std::string& folder, const Json& identity, const EarlierRun& earlier, bool quiet);

  /// The next piece. Throws InputError if the journal has one there that is described otherwise, or if it
  /// cannot be written, std::logic_error for a number that is not finite.
  Json piece(const std::string& description, const std::function<Json()>& compute);

  /// Whether at least so many of the next pieces are there already.
  bool has_next(std::size_t pieces) const { return kept_.size() - next_ >= pieces; }

  /// Removes the file: the study is complete and reported.
  void finish();

 private:
  void read(const Json& identity);
  void append(const Json& line);
  void tell_interrupt() const;

  std::optional<FolderLock> lock_;
  std::string path_;
  struct File {  // closed at the end
    File() = default;
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File();
    int descriptor = -1;
  } file_;
  std::vector<Json> kept_;
  std::size_t next_ = 0;
};

}  // namespace springstab
