% Print what Octave reads of files, as with_python.py does: with_octave.m FUNCTION FILE...
1;
function show (name, x)
  if iscellstr (x)
    printf ("%s\t%s\n", name, strjoin (x(:)', " "));
  elseif ischar (x)
    printf ("%s\t%s\n", name, strjoin (cellstr (x)', " "));
  elseif iscomplex (x)
    show ([name "_real"], real (x));
    show ([name "_imag"], imag (x));
  elseif isnumeric (x)
    printf ("%s\t%s\n", name, strtrim (sprintf ("%.17g ", double (x(:)))));
  end
end
function read_load (path)
  s = load (path);
  if ! isstruct (s)
    error ("no variables");
  end
  for [x, name] = s
    if ! isstruct (x)
      if isfield (s, "about")  % of a .mat, whose first dimension runs first
        x = permute (x, ndims (x):-1:1);
      end
      show (name, x);
    end
  end
end
function read_ncread (path)
  pkg load netcdf
  about = ncinfo (path);
  for v = about.Variables
    show (v.Name, ncread (path, v.Name));
  end
end
function read_csvread (path)
  file = fopen (path); names = strsplit (fgetl (file), ","); fclose (file);
  x = csvread (path, 1, 0);
  if columns (x) != numel (names)
    error ("no table of numbers");
  end
  for k = 1:columns (x)
    show (strsplit (names{k}, " (")(1){1}, x(:, k));
  end
end
for path = argv ()(2:end)'
  printf ("@%s\n", path{1});
  fflush (stdout);
  fprintf (stderr, "@%s\n", path{1});
  try
    feval (["read_" argv(){1}], path{1});
  catch problem
    printf ("!%s\n", strrep (problem.message, "\n", " "));
  end
  fflush (stdout);
end
