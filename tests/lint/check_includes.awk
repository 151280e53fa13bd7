# Holds #include lines against includes.rules. Input: the rules, then lines "file:number:#include ...".

function starts(text, prefix) { return substr(text, 1, length(prefix)) == prefix }

# "" for a library that no item names by its kind.
function kind_of(header) {
  if (header ~ /^(sys|linux|net|netinet|arpa|asm)\// || header ~ /^[^\/]*\.h$/) return "<system>"
  if (header ~ /\//) return ""
  if (header ~ /^(iostream|istream|ostream|fstream|sstream|cstdio|chrono|ctime|thread|mutex|shared_mutex|condition_variable|future|filesystem|csignal)$/) return "<io>"
  return "<std>"
}

# An item fits a header of ours by its prefix; one in <> by its prefix, or by the kind that it names.
function fits(item, header, ours) {
  if (ours) return substr(item, 1, 1) != "<" && starts(header, item)
  if (item == "<std>" || item == "<io>" || item == "<system>") return kind_of(header) == item
  return substr(item, 1, 1) == "<" && starts(header, substr(item, 2, length(item) - 2))
}

function allowed(rule, header, ours,    items, n, i, item, yes) {
  n = split(may[rule], items, " ")
  yes = 0
  for (i = 1; i <= n; ++i) {
    item = items[i]
    if (substr(item, 1, 1) == "!") {
      if (fits(substr(item, 2), header, ours)) yes = 0
    } else if (fits(item, header, ours)) yes = 1
  }
  return yes
}

FILENAME == rules {
  if ($0 ~ /^once /) once[substr($2, 2, length($2) - 2)] = ""
  else if ($0 !~ /^#/ && $2 == ":") {
    from[++rule_count] = $1
    may[rule_count] = substr($0, index($0, ":") + 1)
  }
  next
}

{
  split($0, place, ":")
  file = place[1]
  if (!match($0, /[<"][^>"]*[>"]/)) next
  ours = substr($0, RSTART, 1) == "\""
  header = substr($0, RSTART + 1, RLENGTH - 2)
  for (rule = 1; rule <= rule_count && !starts(file, from[rule]); ++rule);
  if (rule > rule_count) next
  ++checked
  if (!allowed(rule, header, ours)) {
    printf "%s:%s: %s is not for files of %s (tests/lint/includes.rules)\n", file, place[2], header, from[rule]
    bad = 1
  }
  for (prefix in once) {
    if (!ours && starts(header, prefix) && once[prefix] != file) {
      if (once[prefix] != "") { printf "%s: %s is %s's alone\n", file, header, once[prefix]; bad = 1 }
      else once[prefix] = file
    }
  }
}

END {
  if (checked == 0) { print "no include line was found"; bad = 1 }
  exit bad
}
