"""Reports of scenario runs: matrix as text and HTML, JUnit file, pictures of cases, shares of crash cost, sweeps."""
