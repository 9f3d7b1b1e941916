"""A local page that answers a study while sliders move: ``beamprop explore``.

Order of the files here: `controls` lists the values of a study that may be moved, `state` turns their values into a description that
`study.questions` answers, `cost` refuses what would take too long, `panels` answers what the page draws, `equivalents` and `downloads` hand out the
same question as text and as files, `http` reads requests and writes answers, `routes` knows which there are, `server` runs them, `stored` writes a page of stored
results that needs no server. The page itself is in `page/`: plain HTML, CSS and JavaScript.
"""
