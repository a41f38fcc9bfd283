"""What scenario runs show: a matrix for the console, JUnit for a build server, pictures, sweeps, a page."""
