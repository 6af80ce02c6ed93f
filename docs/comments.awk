# What stands indented below an empty line of a comment is an equation, a picture or an example.
# Markdown takes four blanks for that, the headers two. A word that begins a sentence is a word, and no
# class of that name: %, which Doxygen takes off again, says so.
/^ *\/\/\/   +[^ ]/ && (empty || code) {
  sub("///  ", "///      ")
  code = 1
  empty = 0
  print
  next
}
{
  comment = /^ *\/\/\//
  code = 0
  empty = /^ *\/\/\/ *$/
  if (match($0, /\/\/\/<? [A-Z][a-z]+[ ,;:]/) && ($0 ~ /\/\/\/</ || begins)) mark(index(substr($0, RSTART), " ") + RSTART)
  if (comment) {
    rest = $0
    done = ""
    while (match(rest, /[.:] [A-Z][a-z]+[ ,;:]/)) {
      done = done substr(rest, 1, RSTART + 1) "%"
      rest = substr(rest, RSTART + 2)
    }
    $0 = done rest
  }
  begins = !comment || empty || /[.:]$/
  print
}
function mark(at) {
  $0 = substr($0, 1, at - 1) "%" substr($0, at)
}
