# The worked example at the top of a header, as code: of what stands indented before #pragma once, the blocks
# with a statement in them.
function flush() {
  if (statement) printf "%s", block
  block = ""
  statement = 0
}
/^#pragma once/ { flush(); exit }
/^\/\/     / {
  line = substr($0, 8)
  block = block line "\n"
  if (line ~ /;( *\/\/.*)?$/) statement = 1
  next
}
{ flush() }
