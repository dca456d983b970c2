#!/usr/bin/env bash
# Makes the Debian package of BUILD, installs it, uses what it has, and removes it. Skipped (77) where that
# cannot be: not as root, without Debian's tools, or where the package is installed already.
set -euo pipefail
build=$1
[[ $(id -u) == 0 ]] || exit 77
for tool in cpack dpkg dpkg-deb dpkg-shlibdeps; do command -v $tool >/dev/null || exit 77; done
! dpkg-query -s springstab >/dev/null 2>&1 || exit 77

work=$(mktemp -d)
trap 'dpkg -r springstab >/dev/null 2>&1 || true; rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work" >"$work/log" || { cat "$work/log"; fail "no package"; }
package=$(echo "$work"/*.deb)
dpkg-deb -f "$package" Depends | grep -q libgsl || fail "it does not depend on what it is linked with"
contents=$(dpkg-deb -c "$package")
for file in usr/bin/springstab usr/share/man/man1/springstab.1 usr/share/man/man1/springstab-limits.1 \
  usr/share/bash-completion/completions/springstab usr/share/zsh/vendor-completions/_springstab \
  usr/share/fish/vendor_completions.d/springstab.fish usr/share/springstab/plots/region.gp \
  usr/share/doc/springstab/copyright usr/share/doc/springstab/docs/guide.md usr/include/springstab/analysis/method.h; do
  grep -q " \./$file\$" <<<"$contents" || fail "it has no $file"
done

dpkg -i "$package" >/dev/null
cd "$work"
springstab=/usr/bin/springstab
question=(limits --grid 4x4 --pin corners --json)
diff <("$springstab" "${question[@]}") <("$build/springstab" "${question[@]}") ||
  fail "installed it has another answer"
"$springstab" doctor >/dev/null || fail "it is not sound"
"$springstab" figures --help | tr -d '\n ' | grep -q DIR=/usr/share/springstab/plots || fail "it does not know its plots"
if command -v gnuplot >/dev/null; then
  "$springstab" report --grid 4x4 --pin corners --duration 0.01 -o page.html --quiet >/dev/null
  grep -q "<svg" page.html || fail "its report has no pictures"
fi
dpkg -r springstab >/dev/null
[[ ! -e $springstab && ! -e /usr/share/springstab && ! -e /usr/share/doc/springstab ]] || fail "removed, it is still there"
