# Print what R reads of files, as with_python.py does: with_r.R FUNCTION FILE...
options(warn = 1)  # at once, not at the end
show <- function(name, x) {
  words <- if (is.character(x)) as.vector(x) else ifelse(is.finite(x), sprintf("%.17g", as.numeric(x)), as.character(as.numeric(x)))
  cat(name, "\t", paste(words, collapse = " "), "\n", sep = "")
}
read <- list(
  ncdf4 = function(path) {
    library(ncdf4)
    file <- nc_open(path)
    for (name in unique(c(names(file$var), names(file$dim)))) show(name, ncvar_get(file, name))
  },
  read.csv = function(path) {
    table <- read.csv(path, check.names = FALSE)
    for (name in names(table)) show(strsplit(name, " (", fixed = TRUE)[[1]][1], table[[name]])
  }
)
arguments <- commandArgs(trailingOnly = TRUE)
for (path in arguments[-1]) {
  cat("@", path, "\n", sep = "")
  cat("@", path, "\n", sep = "", file = stderr())
  tryCatch(read[[arguments[1]]](path), error = function(problem) cat("!", gsub("\n", " ", conditionMessage(problem)), "\n", sep = ""))
}
